// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/spline_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace realmodel::interpolation {
namespace {

TEST(SplineGrid, SumsToOneRisesAndBendsAsItsDerivatives) {
    const SplineGrid grid({10, 20}, 0.5, 7, 5);
    for (const PlanPosition& position :
         {PlanPosition{10, 20}, {11.3, 21.1}, {13.49, 22.49}, {13.5, 22.5}}) {
        const std::size_t cell = grid.cell_of(position);
        const auto values = grid.values(position, cell);
        double sum = 0;
        for (const double v : values)
            sum += v;
        EXPECT_NEAR(sum, 1, 1e-14);
        constexpr double h = 1e-4;
        const auto at = [&](double dx, double dy) {
            return grid.values({position[0] + dx, position[1] + dy}, cell);
        };
        const auto rises = grid.rises(position, cell, {3, -2});
        const auto bends = grid.bends(position, cell, {2, -1, 3});
        for (std::size_t k = 0; k < SplineGrid::kReach; ++k) {
            const double xx = (at(h, 0)[k] - 2 * values[k] + at(-h, 0)[k]) / (h * h);
            const double yy = (at(0, h)[k] - 2 * values[k] + at(0, -h)[k]) / (h * h);
            const double xy =
                (at(h, h)[k] - at(-h, h)[k] - at(h, -h)[k] + at(-h, -h)[k]) / (4 * h * h);
            const double x = (at(h, 0)[k] - at(-h, 0)[k]) / (2 * h);
            const double y = (at(0, h)[k] - at(0, -h)[k]) / (2 * h);
            EXPECT_NEAR(rises[k], 3 * x - 2 * y, 1e-6);
            EXPECT_NEAR(bends[k], 2 * xx - xy + 3 * yy, 1e-5);
        }
    }
}

TEST(SplineGrid, CellsAndNumbersByHand) {
    const SplineGrid grid({10, 20}, 2, 4, 3);
    EXPECT_EQ(grid.cell_of({10, 20}), 0U);
    EXPECT_EQ(grid.cell_of({13, 23}), 5U);
    EXPECT_EQ(grid.cell_of({99, 99}), 11U);
    EXPECT_EQ(grid.cell_of({0, 0}), 0U);
    EXPECT_EQ(grid.coefficients(), 6U * 5U);
    EXPECT_EQ(grid.number(0, 0), 2U * 10U + 2U);
    EXPECT_EQ(grid.first_of(5), grid.number(1, 1));
    EXPECT_EQ(grid.coarser().columns(), 2U);
    EXPECT_EQ(grid.coarser().rows(), 2U);
    // In the middle of a cell: (1/8, 3/4, 1/8) along each axis.
    const auto values = grid.values({11, 21}, 0);
    EXPECT_EQ(values[0], 1.0 / 64);
    EXPECT_EQ(values[4], 9.0 / 16);
    EXPECT_EQ(values[5], 3.0 / 32);
}

TEST(SplineStencils, AreTheSumOfTheElements) {
    const SplineGrid grid({0, 0}, 1, 5, 4);
    std::mt19937 random(2);
    std::vector<SplineGrid::Element> elements(grid.cells(), SplineGrid::Element{});
    for (auto& element : elements) {
        SplineGrid::SplineWeights weights;
        for (double& weight : weights)
            weight = static_cast<double>(random()) / 4294967296.0;
        add_square(element, weights, 2);
    }
    const std::size_t width = grid.columns() + 2, height = grid.rows() + 2;
    const auto number = [&](std::size_t cell, std::size_t k) {
        return (cell / grid.columns() + k / 3) * width + cell % grid.columns() + k % 3;
    };
    std::vector<std::vector<double>> dense(width * height, std::vector<double>(width * height));
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        for (std::size_t a = 0; a < 9; ++a) {
            for (std::size_t b = 0; b < 9; ++b)
                dense[number(cell, a)][number(cell, b)] += elements[cell][9 * a + b];
        }
    }
    SplineStencils stencils(grid);
    stencils.assemble(elements, 0.25, 2);
    Vector x(grid.length(), 0.0), plain(width * height);
    for (std::size_t i = 0; i < plain.size(); ++i) {
        plain[i] = static_cast<double>(random()) / 4294967296.0;
        x[grid.number(i % width, i / width)] = plain[i];
        EXPECT_NEAR(stencils.entry(i % width, i / width, 12), dense[i][i] + 0.25, 1e-13);
    }
    for (std::ptrdiff_t piece = 0; piece < stencils.sweep().pieces(); ++piece) {
        const auto [begin, end] = stencils.rows(piece);
        Vector out(SplineStencils::kMostRows);
        stencils.times(piece, x.data(), out.data());
        EXPECT_EQ(end - begin, width);
        const auto row = static_cast<std::size_t>(piece);
        for (std::size_t column = 0; column < width; ++column) {
            double expected = 0.25 * plain[row * width + column];
            for (std::size_t i = 0; i < plain.size(); ++i)
                expected += dense[row * width + column][i] * plain[i];
            EXPECT_NEAR(out[column], expected, 1e-12);
        }
    }
}

}  // namespace
}  // namespace realmodel::interpolation
