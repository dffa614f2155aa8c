// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/dsi/roughness.hpp"
#include "interpolation/dsi/smoother.hpp"
#include "interpolation/dsi/spline_grid.hpp"
#include "interpolation/dsi/wavefront_sweep.hpp"

namespace realmodel::interpolation {

/// A constraint of a surface at a position: `strength` times the square of the height there, or of
/// the rise along a vector, is added.
struct WeightedPosition {
    PlanPosition position;
    double strength;
    PlanPosition along{};  ///< zero: the height
};

/// Multigrid on grids of quadratic B-splines, the coarse part of a preconditioner: solves roughness
/// and constraints approximately on the grid, by one V-cycle over ever coarser grids. A symmetric
/// positive operator, as conjugate gradients need it.
class SplineLevels {
public:
    /// @param check  throws to stop; it is called often
    SplineLevels(const SplineGrid& grid, std::span<const PlanPosition> nodes,
                 std::span<const Hinge> hinges, int threads, const std::function<void()>& check);

    /// To be called before solve(), and again when constraints change.
    void set_constraints(std::span<const WeightedPosition> constraints);

    const SplineGrid& grid() const { return levels_.front().stencils.grid(); }

    /// The right side, of grid().length(), to be set before solve(), and the solution after it.
    Vector& right() { return levels_.front().right; }
    const Vector& solution() const { return levels_.front().x; }
    void solve() { cycle(0); }

private:
    struct SplineLevel {
        explicit SplineLevel(const SplineGrid& grid) : stencils(grid) {}
        SplineStencils stencils;
        Smoother smoother;
        Vector right, x;
    };

    void fill_border_cells(std::span<const PlanPosition> nodes, std::span<const Hinge> hinges);
    void restrict_elements(std::vector<SplineGrid::Element>& elements,
                           const SplineGrid& fine) const;
    void assemble(SplineLevel& level, const std::vector<SplineGrid::Element>& elements,
                  double least);
    void factor_coarsest(double least);
    void cycle(std::size_t at);
    int threads_of(const SplineGrid& grid) const;

    int threads_;
    std::function<void()> check_;
    std::vector<SplineGrid::Element> rough_;  // of the finest grid
    std::vector<SplineLevel> levels_;
    Eigen::LDLT<Eigen::MatrixXd> coarsest_;
};

}  // namespace realmodel::interpolation
