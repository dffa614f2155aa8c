// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Eigen's own threads would cut sums differently for each number of them.
#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// The Cholesky factor of a large covariance matrix: L of C = L L^T by square tiles of the lower
/// triangle. It takes half the memory of C, and work can be cancelled after every tile. Rows whose
/// variance, given those before them, is below `redundant` are left out: their part of a solution
/// is 0. The same bytes for any number of threads.
class TiledCholesky {
public:
    static constexpr Eigen::Index kTile = 128;
    using Entry = std::function<double(Eigen::Index row, Eigen::Index column)>;

    /// Bytes that a factor of this order takes.
    static double bytes(double order);

    /// @param entry      gives the lower triangle
    /// @param end_share  the progress goes up to this
    /// @throws Cancelled, and what `entry` throws
    TiledCholesky(Eigen::Index order, const Entry& entry, double redundant,
                  const Execution& execution, double end_share);

    bool left_out(Eigen::Index row) const { return left_out_[row]; }

    /// Overwrites the columns of `right` with L^-1 right. They mean nothing once the caller has
    /// cancelled.
    void solve(Eigen::MatrixXd& right, Progress* progress) const;

    /// Overwrites the columns of `right` with L^-T right. As solve().
    void solve_transposed(Eigen::MatrixXd& right, Progress* progress) const;

    /// Of C, without the rows that are left out.
    double log_determinant() const;

private:
    using Block = Eigen::Map<Eigen::MatrixXd>;
    using ConstBlock = Eigen::Map<const Eigen::MatrixXd>;

    Eigen::Index rows_of(Eigen::Index i) const { return std::min(kTile, order_ - i * kTile); }
    std::size_t offset(Eigen::Index i, Eigen::Index j) const {
        return static_cast<std::size_t>((i * (i + 1) / 2 + j) * kTile * kTile);
    }
    Block block(Eigen::Index i, Eigen::Index j) {
        return {tiles_.data() + offset(i, j), rows_of(i), rows_of(j)};
    }
    ConstBlock block(Eigen::Index i, Eigen::Index j) const {
        return {tiles_.data() + offset(i, j), rows_of(i), rows_of(j)};
    }
    void fill(Eigen::Index i, Eigen::Index j, const Entry& entry);
    void factor_diagonal(Eigen::Index k, double redundant);
    void factor_below(Eigen::Index i, Eigen::Index k);

    Eigen::Index order_;
    Eigen::Index tiles_in_row_;  // tiles in a row
    std::vector<double> tiles_;
    std::vector<bool> left_out_;
};

}  // namespace realmodel::interpolation
