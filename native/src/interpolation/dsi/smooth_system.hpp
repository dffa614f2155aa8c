// SPDX-License-Identifier: GPL-3.0-or-later
// The linear system of discrete smooth interpolation. Private.
#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "interpolation/dsi/roughness.hpp"
#include "interpolation/dsi/smoother.hpp"
#include "interpolation/dsi/spline_levels.hpp"

namespace realmodel::interpolation {

/// A height wanted somewhere on the mesh: strength * (weights . z - height)^2 is added.
struct Wish {
    std::array<std::int32_t, 3> nodes;  ///< the first alone counts where its weight is 1
    std::array<double, 3> weights;
    double strength;

    bool at_node() const { return weights[0] == 1; }
    double of(const Vector& z) const {
        if (at_node()) return z[static_cast<std::size_t>(nodes[0])];
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k)
            sum += weights[k] * z[static_cast<std::size_t>(nodes[k])];
        return sum;
    }
};

/// Roughness and wishes, solved by preconditioned conjugate gradients.
class SmoothSystem {
public:
    /// nodes lie in the order of the cells of `grid`. `check` throws to stop; it is called often.
    SmoothSystem(std::span<const Place> nodes, std::span<const Hinge> hinges,
                 const SplineGrid& grid, int threads, const std::function<void()>& check);

    /// Mean of the diagonal of the roughness near some nodes; what a wish's strength is measured
    /// in.
    double stiffness(const std::array<std::int32_t, 3>& nodes) const;

    /// Whether all that was solved so far came as near as was asked.
    bool converged() const { return converged_; }

    /// The wishes that count from now on.
    void set_wishes(std::span<const Wish> wishes);

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
    std::span<const Place> nodes_;
    int threads_;
    std::function<void()> check_;
    SparseRows rows_;
    SplineLevels levels_;
    std::vector<std::size_t> first_in_cell_;
    Smoother smoother_;
    bool converged_ = true;
    double reference_ = 0;
    std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>
        factor_;                             // where it is needed
    std::vector<SplineGrid::Weights> sums_;  // of each cell
};

}  // namespace realmodel::interpolation
