// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/tiled_cholesky.hpp"

#include <cmath>

#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

double TiledCholesky::bytes(double order) {
    const double side = std::ceil(order / static_cast<double>(tile));
    return side * (side + 1) / 2 * static_cast<double>(tile * tile) * sizeof(double);
}

TiledCholesky::TiledCholesky(Eigen::Index order, const Entry& entry, double redundant, int threads,
                             Progress* progress, double end_share)
    : order_(order),
      tiles_a_side_((order + tile - 1) / tile),
      tiles_(offset(tiles_a_side_, 0)),
      left_out_(static_cast<std::size_t>(order), false) {
    const auto side = tiles_a_side_;
    StopSign stop(progress);
    // The right-looking form: after column k the rest of the matrix is what its factor must give.
    // Column -1 stands for filling the tiles. Nothing in here throws.
    for (Eigen::Index k = -1; k < side; ++k) {
        if (k >= 0) factor_diagonal(k, redundant);
        const Eigen::Index first = k + 1;
        const auto below = [&](auto&& work) {
#pragma omp parallel for schedule(dynamic) num_threads(thread_count(threads))
            for (Eigen::Index i = first; i < side; ++i) {
                for (Eigen::Index j = k < 0 ? 0 : k; j <= i && !stop(); ++j)
                    work(i, j);
            }
        };
        if (k < 0) {
            below([&](Eigen::Index i, Eigen::Index j) {
                Block to = block(i, j);
                for (Eigen::Index c = 0; c < to.cols(); ++c) {
                    for (Eigen::Index r = i == j ? c : 0; r < to.rows(); ++r) {
                        to(r, c) = entry(i * tile + r, j * tile + c);
                    }
                }
            });
        } else {
            below([&](Eigen::Index i, Eigen::Index j) {
                if (j != k) return;
                Block to = block(i, k);
                block(k, k)
                    .triangularView<Eigen::Lower>()
                    .transpose()
                    .solveInPlace<Eigen::OnTheRight>(to);
                for (Eigen::Index c = 0; c < to.cols(); ++c) {
                    if (left_out_[static_cast<std::size_t>(k * tile + c)]) to.col(c).setZero();
                }
            });
            below([&](Eigen::Index i, Eigen::Index j) {
                if (j == k) return;
                block(i, j).noalias() -= block(i, k) * block(j, k).transpose();
            });
        }
        if (progress != nullptr) {
            // The work that is left shrinks with the cube of the columns that are left.
            const double left = static_cast<double>(side - first) / static_cast<double>(side);
            progress->report(end_share * (1 - left * left * left), "factoring all points");
            progress->check();
        }
    }
}

void TiledCholesky::factor_diagonal(Eigen::Index k, double redundant) {
    Block a = block(k, k);
    for (Eigen::Index c = 0; c < a.cols(); ++c) {
        const Eigen::Index below = a.rows() - c - 1;
        if (a(c, c) < redundant) {
            left_out_[static_cast<std::size_t>(k * tile + c)] = true;
            a(c, c) = 1;
            a.col(c).tail(below).setZero();
            continue;
        }
        a(c, c) = std::sqrt(a(c, c));
        a.col(c).tail(below) /= a(c, c);
        for (Eigen::Index j = c + 1; j < a.cols(); ++j) {
            a.col(j).tail(a.rows() - j) -= a(j, c) * a.col(c).tail(a.rows() - j);
        }
    }
}

}  // namespace realmodel::interpolation
