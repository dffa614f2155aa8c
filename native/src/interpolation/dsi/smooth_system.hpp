// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/dsi/roughness.hpp"
#include "interpolation/dsi/smoother.hpp"
#include "interpolation/dsi/spline_levels.hpp"
#include "interpolation/dsi/wavefront_sweep.hpp"

namespace realmodel::interpolation {

/// A height somewhere on a mesh, or the rise of a triangle along a vector: met as well as its
/// weight says, exactly, or a bound. While it is active strength * (value(z) - height)^2 is added
/// to the roughness.
struct Constraint {
    enum class Relation { kWeighted, kEqual, kLeast, kMost };

    std::array<std::int32_t, 3> nodes;  ///< the first alone counts where the other weights are 0
    std::array<double, 3> weights;      ///< of sum 1, or 0 of a rise
    double strength;
    Relation kind;
    double height;
    bool of_node = false;   ///< and not of a point
    double multiplier = 0;  ///< of the augmented Lagrangian
    bool active = true;
    PlanPosition along{};  ///< the vector of a rise

    bool is_rise() const { return along != PlanPosition{}; }
    bool is_bound() const { return kind == Relation::kLeast || kind == Relation::kMost; }

    static Constraint at_node(std::size_t node, double strength, Relation kind, double height) {
        const auto number = static_cast<std::int32_t>(node);
        return {{number, number, number}, {1, 0, 0}, strength, kind, height, true};
    }

    /// How many of the nodes count.
    std::size_t corners() const { return weights[0] == 1 && !is_rise() ? 1 : 3; }

    double value(const Vector& z) const {
        if (corners() == 1) return z[nodes[0]];
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k)
            sum += weights[k] * z[nodes[k]];
        return sum;
    }
    /// The multiplier after a round that gave the heights z.
    double next_multiplier(const Vector& z) const {
        const double sum = multiplier + strength * (height - value(z));
        if (kind == Relation::kLeast) return std::max(0.0, sum);
        if (kind == Relation::kMost) return std::min(0.0, sum);
        return sum;
    }
    double violation(const Vector& z) const {
        const double below = height - value(z);
        if (kind == Relation::kLeast) return std::max(0.0, below);
        if (kind == Relation::kMost) return std::max(0.0, -below);
        return std::abs(below);
    }
    /// Of a rise the center of its triangle.
    PlanPosition position(std::span<const PlanPosition> of) const {
        PlanPosition sum{};
        if (is_rise()) {
            for (const std::int32_t node : nodes) {
                for (std::size_t axis = 0; axis < 2; ++axis)
                    sum[axis] += of[node][axis] / 3;
            }
            return sum;
        }
        for (std::size_t k = 0; k < corners(); ++k) {
            for (std::size_t axis = 0; axis < 2; ++axis)
                sum[axis] += weights[k] * of[nodes[k]][axis];
        }
        return sum;
    }
};

/// The linear system of discrete smooth interpolation: roughness and constraints, solved by
/// preconditioned conjugate gradients.
class SmoothSystem {
public:
    /// @param nodes          in the order of the cells of `grid`
    /// @param first_in_cell  the first node of each cell, and their number
    /// @param check          throws to stop; it is called often
    SmoothSystem(std::span<const PlanPosition> nodes, std::span<const std::size_t> first_in_cell,
                 std::span<const Hinge> hinges, const SplineGrid& grid, int threads,
                 const std::function<void()>& check);

    /// Mean of the diagonal of the roughness near some nodes: the unit of a constraint's strength.
    double stiffness(const std::array<std::int32_t, 3>& nodes) const;

    /// Whether every solution so far reached its tolerance.
    bool converged() const { return converged_; }

    /// Takes the active ones of these constraints, instead of those before.
    void set_constraints(std::span<const Constraint> constraints);

    /// Improves z until its error in the norm of the energy is below `tolerance` of that which zero
    /// has for the first right side ever given. right: the sum of strength * height * weights.
    /// A mesh of very unlike triangles, on which this is slow, is factored if it is not too large.
    /// @return the iterations this took
    int solve(Vector& z, const Vector& right, double tolerance,
              const std::function<void(double)>& report);

private:
    /// out = M^-1 residual; the scalar product of both.
    double precondition(const Vector& residual, Vector& out);
    void correct();
    int iterate(Vector& z, const Vector& right, double goal, int most,
                const std::function<void(double)>& report);
    void factor();

    std::span<const PlanPosition> nodes_;
    int threads_;
    std::function<void()> check_;
    SparseRows rows_;
    SplineLevels levels_;
    std::span<const std::size_t> first_in_cell_;
    Smoother smoother_;
    bool converged_ = true;
    double reference_ = 0;
    std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>
        factor_;                                   // where it is needed
    std::vector<SplineGrid::SplineWeights> sums_;  // of each cell
};

}  // namespace realmodel::interpolation
