// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/tiled_cholesky.hpp"

#include <cmath>

#include "interpolation/node_loop.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

double TiledCholesky::bytes(double order) {
    const double tiles_in_row = std::ceil(order / static_cast<double>(kTile));
    return tiles_in_row * (tiles_in_row + 1) / 2 * static_cast<double>(kTile * kTile) *
           sizeof(double);
}

TiledCholesky::TiledCholesky(Eigen::Index order, const Entry& entry, double redundant,
                             const Execution& execution, double end_share)
    : order_(order),
      tiles_in_row_((order + kTile - 1) / kTile),
      tiles_(offset(tiles_in_row_, 0)),
      left_out_(static_cast<std::size_t>(order), false) {
    // work(i, j) for the tiles of columns first .. last, until the caller cancels.
    const auto for_tiles = [&](Eigen::Index from_row, Eigen::Index first, Eigen::Index last,
                               const auto& work) {
        parallel_chunks(
            static_cast<std::size_t>(tiles_in_row_ - from_row), execution,
            [&](std::size_t row) {
                const Eigen::Index i = from_row + static_cast<Eigen::Index>(row);
                const Eigen::Index end = std::min(i, last);
                for (Eigen::Index j = first; j <= end && !cancelled(execution.progress); ++j)
                    work(i, j);
            },
            0);
    };
    for_tiles(0, 0, tiles_in_row_, [&](Eigen::Index i, Eigen::Index j) { fill(i, j, entry); });
    // The right-looking form: after column k the rest of the matrix is what its factor must give.
    for (Eigen::Index k = 0; k < tiles_in_row_; ++k) {
        factor_diagonal(k, redundant);
        for_tiles(k + 1, k, k, [&](Eigen::Index i, Eigen::Index) { factor_below(i, k); });
        for_tiles(k + 1, k + 1, tiles_in_row_, [&](Eigen::Index i, Eigen::Index j) {
            block(i, j).noalias() -= block(i, k) * block(j, k).transpose();
        });
        if (execution.progress == nullptr) continue;
        // The work that is left shrinks with the cube of the columns that are left.
        const double left =
            static_cast<double>(tiles_in_row_ - k - 1) / static_cast<double>(tiles_in_row_);
        execution.progress->report(end_share * (1 - left * left * left), "factoring all points");
        execution.progress->check();
    }
}

void TiledCholesky::fill(Eigen::Index i, Eigen::Index j, const Entry& entry) {
    Block to = block(i, j);
    for (Eigen::Index c = 0; c < to.cols(); ++c) {
        for (Eigen::Index r = i == j ? c : 0; r < to.rows(); ++r)
            to(r, c) = entry(i * kTile + r, j * kTile + c);
    }
}

void TiledCholesky::factor_diagonal(Eigen::Index k, double redundant) {
    Block a = block(k, k);
    for (Eigen::Index c = 0; c < a.cols(); ++c) {
        const Eigen::Index below = a.rows() - c - 1;
        if (a(c, c) < redundant) {
            left_out_[k * kTile + c] = true;
            a(c, c) = 1;
            a.col(c).tail(below).setZero();
            continue;
        }
        a(c, c) = std::sqrt(a(c, c));
        a.col(c).tail(below) /= a(c, c);
        for (Eigen::Index j = c + 1; j < a.cols(); ++j)
            a.col(j).tail(a.rows() - j) -= a(j, c) * a.col(c).tail(a.rows() - j);
    }
}

void TiledCholesky::factor_below(Eigen::Index i, Eigen::Index k) {
    Block to = block(i, k);
    block(k, k).triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(to);
    for (Eigen::Index c = 0; c < to.cols(); ++c) {
        if (left_out_[k * kTile + c]) to.col(c).setZero();
    }
}

void TiledCholesky::solve(Eigen::MatrixXd& right, Progress* progress) const {
    for (Eigen::Index i = 0; i < tiles_in_row_; ++i) {
        auto mine = right.middleRows(i * kTile, rows_of(i));
        for (Eigen::Index k = 0; k < i; ++k) {
            if (cancelled(progress)) return;
            mine.noalias() -= block(i, k) * right.middleRows(k * kTile, rows_of(k));
        }
        block(i, i).triangularView<Eigen::Lower>().solveInPlace(mine);
        for (Eigen::Index row = i * kTile; row < i * kTile + rows_of(i); ++row) {
            if (left_out_[row]) right.row(row).setZero();
        }
    }
}

void TiledCholesky::solve_transposed(Eigen::MatrixXd& right, Progress* progress) const {
    for (Eigen::Index i = tiles_in_row_ - 1; i >= 0; --i) {
        auto mine = right.middleRows(i * kTile, rows_of(i));
        for (Eigen::Index k = i + 1; k < tiles_in_row_; ++k) {
            if (cancelled(progress)) return;
            mine.noalias() -= block(k, i).transpose() * right.middleRows(k * kTile, rows_of(k));
        }
        // A row that is left out has 0 beside 1 in its column: others do not see it.
        for (Eigen::Index row = i * kTile; row < i * kTile + rows_of(i); ++row) {
            if (left_out_[row]) right.row(row).setZero();
        }
        block(i, i).transpose().triangularView<Eigen::Upper>().solveInPlace(mine);
        for (Eigen::Index row = i * kTile; row < i * kTile + rows_of(i); ++row) {
            if (left_out_[row]) right.row(row).setZero();
        }
    }
}

double TiledCholesky::log_determinant() const {
    double sum = 0;
    for (Eigen::Index i = 0; i < tiles_in_row_; ++i) {
        const ConstBlock a = block(i, i);
        for (Eigen::Index c = 0; c < a.cols(); ++c)
            sum += 2 * elementary::log(a(c, c));
    }
    return sum;
}

}  // namespace realmodel::interpolation
