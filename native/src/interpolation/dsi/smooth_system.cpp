// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/smooth_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

constexpr int kMostIterations = 400;
constexpr int kIterationsBeforeFactor = 60;
constexpr std::size_t kMostFactored = 100'000;
// Of the diagonal: heights that no constraint holds must not make a factor singular.
constexpr double kHeldNode = 1e-13;

}  // namespace

SmoothSystem::SmoothSystem(std::span<const PlanPosition> nodes,
                           std::span<const std::size_t> first_in_cell,
                           std::span<const Hinge> hinges, const SplineGrid& grid, int threads,
                           const std::function<void()>& check)
    : nodes_(nodes),
      threads_(threads),
      check_(check),
      rows_(nodes.size(), hinges, threads),
      levels_(grid, nodes, hinges, threads, check),
      first_in_cell_(first_in_cell),
      sums_(grid.cells()) {
    assert(first_in_cell.size() == grid.cells() + 1 && first_in_cell.back() == nodes.size());
    smoother_.resize(nodes.size());
}

double SmoothSystem::stiffness(const std::array<std::int32_t, 3>& nodes) const {
    double sum = 0;
    for (const std::int32_t node : nodes)
        sum += rows_.rough_diagonal()[node];
    return sum > 0 ? sum / 3 : 1;
}

void SmoothSystem::set_constraints(std::span<const Constraint> constraints) {
    rows_.remove_added();
    std::vector<WeightedPosition> positions;
    for (const Constraint& c : constraints) {
        if (!c.active) continue;
        for (std::size_t a = 0; a < c.corners(); ++a) {
            const double strength = c.strength * c.weights[a];
            for (std::size_t b = 0; b < c.corners(); ++b)
                rows_.add(c.nodes[a], c.nodes[b], strength * c.weights[b]);
        }
        positions.push_back({c.position(nodes_), c.strength, c.along});
    }
    Vector inverse_diagonal(nodes_.size()), ratio(nodes_.size());
    in_pieces(nodes_.size(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double diagonal = rows_.diagonal(i);
            inverse_diagonal[i] = diagonal > 0 ? 1 / diagonal : 1;
            ratio[i] = rows_.magnitude(i) * inverse_diagonal[i];
        }
    });
    const double bound = std::max(1.0, *std::max_element(ratio.begin(), ratio.end()));
    check_();
    const double largest = largest_eigenvalue(rows_, inverse_diagonal, bound, threads_);
    smoother_.set(std::move(inverse_diagonal), largest);
    levels_.set_constraints(positions);
    if (factor_) factor();  // a mesh that asked for it once does so again
}

/// A V-cycle: smoothed on the mesh, corrected on the splines' grids, smoothed again.
double SmoothSystem::precondition(const Vector& residual, Vector& out) {
    if (factor_) {
        check_();
        const auto count = static_cast<Eigen::Index>(residual.size());
        Eigen::Map<Eigen::VectorXd>(out.data(), count) =
            factor_->solve(Eigen::Map<const Eigen::VectorXd>(residual.data(), count));
        return dot(residual, out, threads_);
    }
    check_();
    smoother_.pre_smooth(rows_, residual, out, threads_);
    correct();
    check_();
    return smoother_.post_smooth(rows_, residual, out, threads_);
}

/// The correction of the splines' grids to the residual that smoothing leaves.
void SmoothSystem::correct() {
    const SplineGrid& grid = levels_.grid();
    const Vector& residual = smoother_.residual();
    for_rows(grid.rows(), threads_, [&](std::size_t row) {
        for (std::size_t column = 0, c = row * grid.columns(); column < grid.columns();
             ++column, ++c) {
            SplineGrid::SplineWeights sums{};
            for (std::size_t i = first_in_cell_[c]; i < first_in_cell_[c + 1]; ++i) {
                const auto [x, y] = grid.values_along(nodes_[i], column, row);
                for (std::size_t k = 0; k < SplineGrid::kReach; ++k)
                    sums[k] += y[k / 3] * residual[i] * x[k % 3];
            }
            sums_[c] = sums;
        }
    });
    Vector& right = levels_.right();
    for_rows(grid.rows() + 2, threads_, [&](std::size_t row) {
        double* const to = right.data() + grid.number(0, row);
        std::fill(to, to + grid.columns() + 2, 0.0);
        for (std::size_t k = 0; k < SplineGrid::kReach; ++k) {
            if (row < k / 3 || row - k / 3 >= grid.rows()) continue;
            const SplineGrid::SplineWeights* from = sums_.data() + (row - k / 3) * grid.columns();
            for (std::size_t column = 0; column < grid.columns(); ++column)
                to[column + k % 3] += from[column][k];
        }
    });
    levels_.solve();
    const Vector& coarse = levels_.solution();
    Vector& correction = smoother_.correction();
    for_rows(grid.rows(), threads_, [&](std::size_t row) {
        for (std::size_t column = 0, c = row * grid.columns(); column < grid.columns();
             ++column, ++c) {
            const double* from = coarse.data() + grid.first_of(c);
            for (std::size_t i = first_in_cell_[c]; i < first_in_cell_[c + 1]; ++i) {
                const auto [x, y] = grid.values_along(nodes_[i], column, row);
                double sum = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const double* line = from + k * grid.stride();
                    sum += y[k] * (x[0] * line[0] + x[1] * line[1] + x[2] * line[2]);
                }
                correction[i] = sum;
            }
        }
    });
}

void SmoothSystem::factor() {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t row = 0; row < nodes_.size(); ++row) {
        const auto at = static_cast<int>(row);
        rows_.for_entries(row, [&](std::int32_t column, double value) {
            if (column <= at) entries.emplace_back(at, column, value);
        });
        const double diagonal = rows_.diagonal(row);
        entries.emplace_back(at, at, kHeldNode * (diagonal > 0 ? diagonal : 1));
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
        reference_ = std::sqrt(std::max(0.0, precondition(right, better)));
        if (!(reference_ > 0)) return 0;
    }
    const double goal = tolerance * reference_;
    const bool small = nodes_.size() <= kMostFactored;
    int iterations =
        iterate(z, right, goal, small ? kIterationsBeforeFactor : kMostIterations, report);
    if (small && iterations == kIterationsBeforeFactor && !factor_) {
        factor();
        iterations += iterate(z, right, goal, kMostIterations, report);
    }
    return iterations;
}

int SmoothSystem::iterate(Vector& z, const Vector& right, double goal, int most,
                          const std::function<void(double)>& report) {
    const std::size_t count = z.size();
    Vector residual(count), better(count), direction(count, 0.0), product(count);
    in_pieces(count, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            residual[i] = right[i] - rows_.times(i, z.data());
    });
    double energy = precondition(residual, better), ratio = 0;
    const double start = std::sqrt(std::max(energy, 0.0));
    int iteration = 0;
    for (; iteration < most && energy > goal * goal; ++iteration) {
        check_();
        const double curvature =
            rows_.sweep().sum(2, threads_, [&](std::size_t stage, std::ptrdiff_t piece) {
                const auto [begin, end] = rows_.rows(piece);
                if (stage == 0) {
                    for (std::size_t i = begin; i < end; ++i)
                        direction[i] = better[i] + ratio * direction[i];
                    return 0.0;
                }
                rows_.times(piece, direction.data(), product.data() + begin);
                double sum = 0;
                for (std::size_t i = begin; i < end; ++i)
                    sum += direction[i] * product[i];
                return sum;
            });
        if (!(curvature > 0)) break;  // only rounding is left
        const double step = energy / curvature;
        in_pieces(count, threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                z[i] += step * direction[i];
                residual[i] -= step * product[i];
            }
        });
        const double next = precondition(residual, better);
        ratio = next / energy;
        energy = next;
        // The error falls by nearly the same factor each time.
        if (start > goal && energy > 0)
            report(elementary::log(start / std::sqrt(energy)) / elementary::log(start / goal));
    }
    converged_ = !(energy > goal * goal) || iteration < most;
    return iteration;
}

}  // namespace realmodel::interpolation
