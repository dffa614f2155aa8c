// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <new>

#include "interpolation/dsi/roughness.hpp"
#include "lattice.hpp"

namespace realmodel::interpolation {
namespace {

TEST(Roughness, LinearHeightsHaveNoneAndQuadraticOnesWhatTheyBend) {
    const Lattice mesh = lattice(9, 7);
    const auto of_mesh = hinges(mesh.nodes, mesh.triangles);
    EXPECT_EQ(of_mesh.size(), 8 * 6 + 7 * 6 + 8 * 5U);  // diagonals, and inner edges along the axes
    const SparseRows rows(mesh.nodes.size(), of_mesh, 2);
    Vector plane, bowl;
    for (const auto& [x, y] : mesh.nodes) {
        plane.push_back(3 + 2 * x - y);
        bowl.push_back(x * x - 3 * x * y + 0.5 * y * y);
    }
    for (std::size_t i = 0; i < plane.size(); ++i)
        EXPECT_NEAR(rows.times(i, plane.data()), 0, 1e-12);
    double energy = 0, bent = 0;
    for (std::size_t i = 0; i < bowl.size(); ++i)
        energy += bowl[i] * rows.times(i, bowl.data());
    for (const Hinge& h : of_mesh)
        bent += std::pow(h.bending[0] * 2 + h.bending[1] * -3 + h.bending[2] * 1, 2);
    EXPECT_NEAR(energy, bent, 1e-9 * energy);
    EXPECT_GT(energy, 1);
}

TEST(Hinges, OfTwoTrianglesByHand) {
    // A unit square cut along the diagonal from 0 to 2: L^2 / (A + B) = 2, heights sqrt(1/2).
    const std::vector<PlanPosition> nodes{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
    const auto found = hinges(nodes, triangles);
    ASSERT_EQ(found.size(), 1U);
    const Hinge& h = found[0];
    EXPECT_EQ(h.nodes, (std::array<std::int32_t, 4>{0, 2, 1, 3}));
    EXPECT_EQ(h.middle, (PlanPosition{0.5, 0.5}));
    // The slope across jumps by (z1 + z3 - z0 - z2) / sqrt(1/2): squared, times 2, is 4 times.
    for (int k = 0; k < 4; ++k)
        EXPECT_NEAR(h.g[k], k < 2 ? -2 : 2, 1e-14);
    EXPECT_NEAR(h.bending[0], 0, 1e-14);
    EXPECT_NEAR(h.bending[1], -2, 1e-14);  // of z = x y: (0 + 0 - 0 - 1) * 2
    EXPECT_NEAR(h.bending[2], 0, 1e-14);
}

TEST(Hinges, ATriangleWithoutOneHasAStandIn) {
    const std::vector<PlanPosition> nodes{{0, 0}, {1, 0}, {0, 1}, {2, 0}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{2, 1, 0}, {0, 1, 3}};
    const auto found = hinges(nodes, triangles);  // the second has no area
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].nodes, (std::array<std::int32_t, 4>{2, 1, 0, 0}));
    EXPECT_EQ(found[1].g, (std::array<double, 4>{}));
}

TEST(SparseRows, WhatIsAddedCanBeRemoved) {
    const Lattice mesh = lattice(6, 5);
    SparseRows rows(mesh.nodes.size(), hinges(mesh.nodes, mesh.triangles), 1);
    const auto row = [&](std::size_t number) {
        Vector out(mesh.nodes.size(), 0.0);
        rows.for_entries(number, [&](std::int32_t column, double value) { out[column] += value; });
        return out;
    };
    const Vector before = row(7);
    EXPECT_EQ(rows.diagonal(7), rows.rough_diagonal()[7]);
    rows.add(7, 7, 2);
    rows.add(7, 8, -3);
    rows.add(7, 7, 0.5);
    Vector expected = before;
    expected[7] += 2;
    expected[7] += 0.5;
    expected[8] -= 3;
    EXPECT_EQ(row(7), expected);
    double magnitude = 0;
    for (const double value : expected)
        magnitude += std::abs(value);
    EXPECT_NEAR(rows.magnitude(7), magnitude, 1e-12);
    rows.remove_added();
    EXPECT_EQ(row(7), before);
}

TEST(SparseRows, ProductsOfPiecesAreThoseOfRows) {
    const Lattice mesh = lattice(50, 43);  // several pieces, the last not full
    const SparseRows rows(mesh.nodes.size(), hinges(mesh.nodes, mesh.triangles), 3);
    Vector x(mesh.nodes.size());
    for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = std::sin(static_cast<double>(i));
    std::size_t next = 0;
    for (std::ptrdiff_t piece = 0; piece < rows.sweep().pieces(); ++piece) {
        const auto [begin, end] = rows.rows(piece);
        EXPECT_EQ(begin, next);
        Vector out(SparseRows::kMostRows);
        rows.times(piece, x.data(), out.data());
        for (std::size_t i = begin; i < end; ++i)
            EXPECT_EQ(out[i - begin], rows.times(i, x.data()));
        next = end;
    }
    EXPECT_EQ(next, x.size());
}

}  // namespace
}  // namespace realmodel::interpolation
