// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "interpolation/dsi/constraint.hpp"
#include "interpolation/dsi/smoother.hpp"
#include "interpolation/dsi/sparse_rows.hpp"
#include "interpolation/dsi/spline_levels.hpp"

namespace realmodel::interpolation {

/// The linear system of discrete smooth interpolation: roughness and constraints, solved by
/// preconditioned conjugate gradients.
class SmoothSystem {
public:
    /// @param nodes          in the order of the cells of `grid`
    /// @param first_in_cell  the first node of each cell, and their number
    /// @param check          throws to stop; it is called often
    SmoothSystem(std::span<const Position> nodes, std::span<const std::size_t> first_in_cell,
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

    std::span<const Position> nodes_;
    int threads_;
    std::function<void()> check_;
    SparseRows rows_;
    SplineLevels levels_;
    std::span<const std::size_t> first_in_cell_;
    Smoother smoother_;
    bool converged_ = true;
    double reference_ = 0;
    std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>
        factor_;                             // where it is needed
    std::vector<SplineGrid::Weights> sums_;  // of each cell
};

}  // namespace realmodel::interpolation
