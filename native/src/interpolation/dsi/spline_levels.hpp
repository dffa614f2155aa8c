// SPDX-License-Identifier: GPL-3.0-or-later
// Multigrid on grids of quadratic B-splines: the coarse part of a preconditioner. Private.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/dsi/roughness.hpp"
#include "interpolation/dsi/smoother.hpp"
#include "interpolation/dsi/spline_grid.hpp"
#include "interpolation/dsi/vectors.hpp"

namespace realmodel::interpolation {

/// Something that pulls a surface at a place: its square times `strength` is added.
struct Pull {
    Place place;
    double strength;
};

/// Solves roughness and pulls approximately on the grid, by one V-cycle over ever coarser grids. A
/// symmetric positive operator, as conjugate gradients need it of a preconditioner.
class SplineLevels {
public:
    /// Throws whatever `check` throws; it is called often.
    SplineLevels(const SplineGrid& grid, std::span<const Place> nodes,
                 std::span<const Hinge> hinges, int threads, const std::function<void()>& check);

    /// To be called before solve(), and again when pulls change.
    void set_pulls(std::span<const Pull> pulls);

    const SplineGrid& grid() const { return levels_.front().stencils.grid(); }

    /// The right side, of grid().length(), to be filled; then the solution after solve().
    Vector& right() { return levels_.front().right; }
    const Vector& solution() const { return levels_.front().x; }
    void solve();

private:
    struct Level {
        explicit Level(const SplineGrid& grid) : stencils(grid) {}
        SplineStencils stencils;
        Smoother smoother;
        Vector right, x;
    };

    void fill_up(std::span<const Place> nodes, std::span<const Hinge> hinges);
    void restrict_elements(std::vector<SplineGrid::Element>& elements,
                           const SplineGrid& fine) const;
    void assemble(Level& level, const std::vector<SplineGrid::Element>& elements, double least);
    void factor_coarsest(double least);
    void cycle(std::size_t at);
    int threads_of(const SplineGrid& grid) const;

    int threads_;
    std::function<void()> check_;
    std::vector<SplineGrid::Element> rough_;  // of the finest grid
    std::vector<Level> levels_;
    Eigen::LDLT<Eigen::MatrixXd> coarsest_;
    std::vector<std::size_t> coarsest_numbers_;
};

}  // namespace realmodel::interpolation
