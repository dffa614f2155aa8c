// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/spline_levels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lattice.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

TEST(SplineLevels, IsSymmetricPositive) {
    const Lattice mesh = lattice(80, 60);
    const auto of_mesh = hinges(mesh.nodes, mesh.triangles);
    const SplineGrid grid({0, 0}, 2, 40, 30);
    SplineLevels levels(grid, mesh.nodes, of_mesh, 1, [] {});
    levels.set_constraints(
        std::vector<WeightedPosition>{{{5, 5}, 10}, {{70, 8}, 10}, {{33, 50}, 10}});
    std::mt19937 random(3);
    const auto drawn = [&] {
        Vector v(grid.length(), 0.0);
        for (std::size_t row = 0; row < grid.rows() + 2; ++row) {
            for (std::size_t column = 0; column < grid.columns() + 2; ++column)
                v[grid.number(column, row)] = static_cast<double>(random()) / 4294967296.0 - 0.5;
        }
        return v;
    };
    const Vector a = drawn(), b = drawn();
    const auto solved = [&](const Vector& right) {
        levels.right() = right;
        levels.solve();
        return levels.solution();
    };
    const Vector x = solved(a), y = solved(b);
    EXPECT_NEAR(dot(a, y, 1), dot(b, x, 1), 1e-6 * std::abs(dot(a, x, 1)));
    EXPECT_GT(dot(a, x, 1), 0);
    EXPECT_GT(dot(b, y, 1), 0);
}

TEST(SplineLevels, OnTheCoarsestGridItSolvesExactly) {
    // One grid of few coefficients, so no V-cycle: what is solved, times the matrix, is given back.
    const Lattice mesh = lattice(9, 9);
    const SplineGrid grid({0, 0}, 2, 4, 4);
    const auto of_mesh = hinges(mesh.nodes, mesh.triangles);
    SplineLevels levels(grid, mesh.nodes, of_mesh, 1, [] {});
    const std::vector<WeightedPosition> constraints{
        {{1, 1}, 5}, {{7, 2}, 5}, {{4, 7}, 5}, {{3, 4}, 8, {1, 2}}, {{5, 5}, 8, {-1, 1}}};
    levels.set_constraints(constraints);
    // A plane has no roughness: the right side of its heights at the constraints gives it.
    const auto plane = [](const PlanPosition& p) { return 2 + 0.5 * p[0] - p[1]; };
    levels.right().assign(grid.length(), 0.0);
    for (const auto& [position, strength, along] : constraints) {
        const std::size_t cell = grid.cell_of(position);
        const bool is_rise = along != PlanPosition{};
        const auto weights =
            is_rise ? grid.rises(position, cell, along) : grid.values(position, cell);
        const double value = is_rise ? 0.5 * along[0] - along[1] : plane(position);
        for (std::size_t k = 0; k < SplineGrid::kReach; ++k) {
            levels.right()[grid.first_of(cell) + k / 3 * grid.stride() + k % 3] +=
                strength * weights[k] * value;
        }
    }
    levels.solve();
    for (const PlanPosition& p :
         {PlanPosition{0.5, 0.5}, PlanPosition{6, 3}, PlanPosition{4, 6.5}}) {
        const std::size_t cell = grid.cell_of(p);
        const auto weights = grid.values(p, cell);
        double height = 0;
        for (std::size_t k = 0; k < SplineGrid::kReach; ++k) {
            height +=
                weights[k] * levels.solution()[grid.first_of(cell) + k / 3 * grid.stride() + k % 3];
        }
        EXPECT_NEAR(height, plane(p), 1e-6);
    }
}

TEST(SplineLevels, WhatItsCheckThrowsReachesTheCaller) {
    const Lattice mesh = lattice(40, 40);
    int checks = 0;
    SplineLevels levels(SplineGrid({0, 0}, 2, 20, 20), mesh.nodes,
                        hinges(mesh.nodes, mesh.triangles), 2, [&] {
                            if (++checks == 4) throw Cancelled();
                        });
    EXPECT_THROW(
        {
            levels.set_constraints({});
            for (int i = 0; i < 4; ++i)
                levels.solve();
        },
        Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
