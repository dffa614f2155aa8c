// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/smooth_system.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::interpolation {

namespace {

constexpr int smoothing_degree = 3;
constexpr int most_iterations = 400;
constexpr int iterations_before_factor = 60;
constexpr std::size_t most_factored = 100'000;
constexpr double held =
    1e-13;  // of the diagonal: what nothing holds must not make a factor singular

}  // namespace

SmoothSystem::SmoothSystem(std::span<const Place> nodes, std::span<const Hinge> hinges,
                           const SplineGrid& grid, int threads, const std::function<void()>& check)
    : nodes_(nodes),
      threads_(threads),
      check_(check),
      rough_(nodes.size(), hinges, threads),
      levels_(grid, nodes, hinges, threads, check),
      first_in_cell_(grid.cells() + 1, 0),
      at_node_(nodes.size(), 0.0),
      inverse_diagonal_(nodes.size()),
      smooth_residual_(nodes.size()),
      step_(nodes.size()),
      product_(nodes.size()),
      sums_(grid.cells()) {
    for (const Place& node : nodes)
        ++first_in_cell_[grid.cell_of(node) + 1];
    for (std::size_t c = 1; c < first_in_cell_.size(); ++c)
        first_in_cell_[c] += first_in_cell_[c - 1];
}

double SmoothSystem::stiffness(const std::array<std::int32_t, 3>& nodes) const {
    double sum = 0;
    for (const std::int32_t node : nodes)
        sum += rough_.diagonal()[static_cast<std::size_t>(node)];
    return sum > 0 ? sum / 3 : 1;
}

void SmoothSystem::set_wishes(std::span<const Wish> wishes) {
    between_.clear();
    std::fill(at_node_.begin(), at_node_.end(), 0.0);
    std::vector<Pull> pulls;
    pulls.reserve(wishes.size());
    Vector diagonal = rough_.diagonal(), magnitude(nodes_.size());
    in_pieces(nodes_.size(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            magnitude[i] = rough_.magnitude(i);
    });
    for (const Wish& wish : wishes) {
        Place place{};
        if (wish.at_node()) {
            const auto node = static_cast<std::size_t>(wish.nodes[0]);
            at_node_[node] += wish.strength;
            diagonal[node] += wish.strength;
            magnitude[node] += wish.strength;
            place = nodes_[node];
        } else {
            between_.push_back(wish);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto node = static_cast<std::size_t>(wish.nodes[k]);
                diagonal[node] += wish.strength * wish.weights[k] * wish.weights[k];
                magnitude[node] += wish.strength * wish.weights[k];  // the weights sum to 1
                for (std::size_t axis = 0; axis < 2; ++axis)
                    place[axis] += wish.weights[k] * nodes_[node][axis];
            }
        }
        pulls.push_back({place, wish.strength});
    }
    double bound = 1;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        inverse_diagonal_[i] = diagonal[i] > 0 ? 1 / diagonal[i] : 1;
        bound = std::max(bound, magnitude[i] * inverse_diagonal_[i]);
    }
    levels_.set_pulls(pulls);
    if (factor_) factor();  // a mesh that asked for it once does so again
    largest_ = largest_eigenvalue(inverse_diagonal_, bound, threads_,
                                  [&](const Vector& x, Vector& out) { multiply(x, out); });
}

void SmoothSystem::multiply(const Vector& x, Vector& out) const {
    check_();
    in_pieces(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            out[i] = rough_.times(i, x.data()) + at_node_[i] * x[i];
    });
    for (const Wish& wish : between_) {
        const double pull = wish.strength * wish.of(x);
        for (std::size_t k = 0; k < 3; ++k)
            out[static_cast<std::size_t>(wish.nodes[k])] += pull * wish.weights[k];
    }
}

/// A V-cycle: smoothed on the mesh, corrected on the splines' grids, smoothed again.
void SmoothSystem::precondition(const Vector& residual, Vector& out) {
    if (factor_) {
        check_();
        const auto count = static_cast<Eigen::Index>(residual.size());
        Eigen::Map<Eigen::VectorXd>(out.data(), count) =
            factor_->solve(Eigen::Map<const Eigen::VectorXd>(residual.data(), count));
        return;
    }
    const SplineGrid& grid = levels_.grid();
    const auto times = [&](const Vector& x, Vector& product) { multiply(x, product); };
    std::fill(out.begin(), out.end(), 0.0);
    smooth_residual_ = residual;
    chebyshev(out, smooth_residual_, step_, product_, inverse_diagonal_, largest_, smoothing_degree,
              threads_, times);
    const auto residual_of = [&](const Vector& x) {
        multiply(x, product_);
        in_pieces(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                smooth_residual_[i] = residual[i] - product_[i];
        });
    };
    residual_of(out);
    in_pieces(grid.cells(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            sums_[c].fill(0);
            for (std::size_t i = first_in_cell_[c]; i < first_in_cell_[c + 1]; ++i) {
                const SplineGrid::Weights weights = grid.values(nodes_[i], c);
                for (std::size_t k = 0; k < SplineGrid::reach; ++k)
                    sums_[c][k] += weights[k] * smooth_residual_[i];
            }
        }
    });
    Vector& right = levels_.right();
    in_pieces(grid.rows() + 2, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            for (std::size_t column = 0; column < grid.columns() + 2; ++column) {
                double sum = 0;
                for (std::size_t k = 0; k < SplineGrid::reach; ++k) {
                    if (column < k % 3 || row < k / 3) continue;
                    const std::size_t i = column - k % 3, j = row - k / 3;
                    if (i < grid.columns() && j < grid.rows())
                        sum += sums_[j * grid.columns() + i][k];
                }
                right[grid.number(column, row)] = sum;
            }
        }
    });
    levels_.solve();
    const Vector& coarse = levels_.solution();
    in_pieces(grid.cells(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            const double* from = coarse.data() + grid.first_of(c);
            for (std::size_t i = first_in_cell_[c]; i < first_in_cell_[c + 1]; ++i) {
                const SplineGrid::Weights weights = grid.values(nodes_[i], c);
                for (std::size_t k = 0; k < SplineGrid::reach; ++k)
                    out[i] += weights[k] * from[k / 3 * grid.stride() + k % 3];
            }
        }
    });
    residual_of(out);
    chebyshev(out, smooth_residual_, step_, product_, inverse_diagonal_, largest_, smoothing_degree,
              threads_, times);
}

void SmoothSystem::factor() {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t row = 0; row < nodes_.size(); ++row) {
        const auto at = static_cast<int>(row);
        rough_.for_entries(row, [&](std::int32_t column, double value) {
            if (column <= at) entries.emplace_back(at, column, value);
        });
        entries.emplace_back(at, at, at_node_[row] + held / inverse_diagonal_[row]);
    }
    for (const Wish& wish : between_) {
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t b = 0; b < 3; ++b) {
                if (wish.nodes[b] > wish.nodes[a]) continue;
                entries.emplace_back(wish.nodes[a], wish.nodes[b],
                                     wish.strength * wish.weights[a] * wish.weights[b]);
            }
        }
    }
    const auto count = static_cast<Eigen::Index>(nodes_.size());
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    factor_ = std::make_unique<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(matrix);
    if (factor_->info() != Eigen::Success) factor_.reset();
}

int SmoothSystem::solve(Vector& z, const Vector& right, double tolerance,
                        const std::function<void(double)>& report) {
    if (reference_ == 0) {
        Vector better(z.size());
        precondition(right, better);
        reference_ = std::sqrt(std::max(0.0, dot(right, better, threads_)));
        if (!(reference_ > 0)) return 0;
    }
    const double goal = tolerance * reference_;
    const bool small = nodes_.size() <= most_factored;
    int iterations =
        iterate(z, right, goal, small ? iterations_before_factor : most_iterations, report);
    if (small && iterations == iterations_before_factor && !factor_) {
        factor();
        iterations += iterate(z, right, goal, most_iterations, report);
    }
    return iterations;
}

int SmoothSystem::iterate(Vector& z, const Vector& right, double goal, int most,
                          const std::function<void(double)>& report) {
    const std::size_t count = z.size();
    Vector residual(count), better(count), direction(count), product(count);
    multiply(z, product);
    for (std::size_t i = 0; i < count; ++i)
        residual[i] = right[i] - product[i];
    precondition(residual, better);
    direction = better;
    double energy = dot(residual, better, threads_);
    const double start = std::sqrt(std::max(energy, 0.0));
    int iteration = 0;
    for (; iteration < most && energy > goal * goal; ++iteration) {
        multiply(direction, product);
        const double curvature = dot(direction, product, threads_);
        if (!(curvature > 0)) break;  // all that is left is rounding
        const double step = energy / curvature;
        in_pieces(count, threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                z[i] += step * direction[i];
                residual[i] -= step * product[i];
            }
        });
        precondition(residual, better);
        const double next = dot(residual, better, threads_);
        const double ratio = next / energy;
        energy = next;
        in_pieces(count, threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                direction[i] = better[i] + ratio * direction[i];
        });
        // The error falls by nearly the same factor each time.
        if (start > goal && energy > 0) {
            report(std::log(start / std::sqrt(energy)) / std::log(start / goal));
        }
    }
    converged_ = !(energy > goal * goal) || iteration < most;
    return iteration;
}

}  // namespace realmodel::interpolation
