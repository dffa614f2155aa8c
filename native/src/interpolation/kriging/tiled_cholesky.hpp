// SPDX-License-Identifier: GPL-3.0-or-later
// Cholesky factor of a large covariance matrix, in tiles. Private.
#pragma once

// Eigen's own threads would cut sums differently for each number of them.
#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {

/// L of C = L L^T by square tiles of the lower triangle; half the memory of C, and every tile is a
/// piece of work after which it can be stopped. Rows whose variance, given those before them, is
/// below `redundant` are left out: their part of a solution is 0.
/// The same bytes for any number of threads.
class TiledCholesky {
public:
    static constexpr Eigen::Index tile = 128;
    using Entry = std::function<double(Eigen::Index row, Eigen::Index column)>;

    /// Bytes that a factor of this order takes.
    static double bytes(double order);

    /// `entry` gives the lower triangle. Throws Cancelled; progress goes up to `end_share`.
    TiledCholesky(Eigen::Index order, const Entry& entry, double redundant, int threads,
                  Progress* progress, double end_share);

    Eigen::Index order() const { return order_; }
    bool left_out(Eigen::Index row) const { return left_out_[static_cast<std::size_t>(row)]; }

    /// Overwrites the columns of `right` with L^-1 right. `stop()` is asked between tiles; the
    /// result means nothing once it has said yes.
    template <class Stop>
    void solve(Eigen::MatrixXd& right, Stop&& stop) const;

private:
    using Block = Eigen::Map<Eigen::MatrixXd>;
    using ConstBlock = Eigen::Map<const Eigen::MatrixXd>;

    Eigen::Index rows_of(Eigen::Index i) const { return std::min(tile, order_ - i * tile); }
    std::size_t offset(Eigen::Index i, Eigen::Index j) const {
        return static_cast<std::size_t>((i * (i + 1) / 2 + j) * tile * tile);
    }
    Block block(Eigen::Index i, Eigen::Index j) {
        return {tiles_.data() + offset(i, j), rows_of(i), rows_of(j)};
    }
    ConstBlock block(Eigen::Index i, Eigen::Index j) const {
        return {tiles_.data() + offset(i, j), rows_of(i), rows_of(j)};
    }
    void factor_diagonal(Eigen::Index k, double redundant);

    Eigen::Index order_;
    Eigen::Index tiles_a_side_;
    std::vector<double> tiles_;
    std::vector<bool> left_out_;
};

template <class Stop>
void TiledCholesky::solve(Eigen::MatrixXd& right, Stop&& stop) const {
    for (Eigen::Index i = 0; i < tiles_a_side_; ++i) {
        auto mine = right.middleRows(i * tile, rows_of(i));
        for (Eigen::Index k = 0; k < i; ++k) {
            if (stop()) return;
            mine.noalias() -= block(i, k) * right.middleRows(k * tile, rows_of(k));
        }
        block(i, i).triangularView<Eigen::Lower>().solveInPlace(mine);
        for (Eigen::Index row = i * tile; row < i * tile + rows_of(i); ++row) {
            if (left_out_[static_cast<std::size_t>(row)]) right.row(row).setZero();
        }
    }
}

}  // namespace realmodel::interpolation
