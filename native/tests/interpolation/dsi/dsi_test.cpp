// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/dsi.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>

#include "../dense_kriging.hpp"
#include "interpolation/dsi/roughness.hpp"
#include "interpolation/dsi/spline_levels.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {
namespace {

struct Lattice {
    Nodes nodes;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Rows of right triangles, every other row turned, jittered inside.
Lattice lattice(int columns, int rows, double jitter = 0.2) {
    std::mt19937 random(7);
    const auto shift = [&] {
        return jitter * (static_cast<double>(random()) / 4294967296.0 - 0.5);
    };
    Lattice out;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const bool inner = i > 0 && j > 0 && i < columns - 1 && j < rows - 1;
            out.nodes.push_back({i + (inner ? shift() : 0), j + (inner ? shift() : 0)});
            if (i == columns - 1 || j == rows - 1) continue;
            const std::int32_t a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
            if ((i + j) % 2 == 0) {
                out.triangles.push_back({a, b, d});
                out.triangles.push_back({a, d, c});
            } else {
                out.triangles.push_back({a, b, c});
                out.triangles.push_back({b, d, c});
            }
        }
    }
    return out;
}

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

TEST(SplineGrid, SumsToOneAndBendsAsItsSecondDerivatives) {
    const SplineGrid grid({10, 20}, 0.5, 7, 5);
    for (const Place& place : {Place{10, 20}, {11.3, 21.1}, {13.49, 22.49}, {13.5, 22.5}}) {
        const std::size_t cell = grid.cell_of(place);
        const auto values = grid.values(place, cell);
        double sum = 0;
        for (const double v : values)
            sum += v;
        EXPECT_NEAR(sum, 1, 1e-14);
        constexpr double h = 1e-4;
        const auto at = [&](double dx, double dy) {
            return grid.values({place[0] + dx, place[1] + dy}, cell);
        };
        const auto bends = grid.bends(place, cell, {2, -1, 3});
        for (std::size_t k = 0; k < SplineGrid::reach; ++k) {
            const double xx = (at(h, 0)[k] - 2 * values[k] + at(-h, 0)[k]) / (h * h);
            const double yy = (at(0, h)[k] - 2 * values[k] + at(0, -h)[k]) / (h * h);
            const double xy =
                (at(h, h)[k] - at(-h, h)[k] - at(h, -h)[k] + at(-h, -h)[k]) / (4 * h * h);
            EXPECT_NEAR(bends[k], 2 * xx - xy + 3 * yy, 1e-5);
        }
    }
}

TEST(SplineLevels, IsSymmetricPositive) {
    const Lattice mesh = lattice(80, 60);
    const auto of_mesh = hinges(mesh.nodes, mesh.triangles);
    const SplineGrid grid({0, 0}, 2, 40, 30);
    SplineLevels levels(grid, mesh.nodes, of_mesh, 1, [] {});
    levels.set_pulls(std::vector<Pull>{{{5, 5}, 10}, {{70, 8}, 10}, {{33, 50}, 10}});
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

Points on(const Lattice& mesh, int count, const std::function<double(double, double)>& height) {
    Points points = hills(count, 1);
    for (auto& p : points) {
        p[0] *= mesh.nodes.back()[0];
        p[1] *= mesh.nodes.back()[1];
        p[2] = height(p[0], p[1]);
    }
    return points;
}

TEST(Dsi, IterationsDoNotGrowWithTheMesh) {
    for (const double weight : {0.0, 1.0}) {
        std::vector<int> iterations;
        for (const int side : {40, 41, 43, 160}) {
            const Lattice mesh = lattice(side, side);
            const auto height = [&](double x, double y) {
                return 100 * std::sin(5 * x / side) * std::cos(4 * y / side);
            };
            const DsiHeights found =
                dsi(on(mesh, 150, height), mesh.nodes, mesh.triangles, {}, {weight, 1});
            iterations.push_back(found.iterations);
            double worst = 0;
            for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
                worst = std::max(worst,
                                 std::abs(found.z[i] - height(mesh.nodes[i][0], mesh.nodes[i][1])));
            EXPECT_LT(worst, 35);
        }
        for (const int count : iterations)
            EXPECT_LT(count, weight > 0 ? 30 : 60);
    }
}

TEST(Dsi, GradedMeshesAndSlivers) {
    // Columns that narrow: triangles of every shape. What multigrid is slow on is factored.
    for (const double power : {2.0, 3.0}) {
        Lattice mesh = lattice(40, 40, 0);
        for (auto& node : mesh.nodes)
            node[0] = std::pow(node[0] / 39, power) * 39;
        const auto plane_at = [](double x, double y) { return 1 + 0.2 * x - 0.3 * y; };
        const DsiHeights plane =
            dsi(on(mesh, 60, plane_at), mesh.nodes, mesh.triangles, {}, {0, 1});
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
            EXPECT_NEAR(plane.z[i], plane_at(mesh.nodes[i][0], mesh.nodes[i][1]), 1e-9);
        const auto bowl_at = [](double x, double y) { return 0.01 * (x * x + y * y); };
        const DsiHeights bowl = dsi(on(mesh, 60, bowl_at), mesh.nodes, mesh.triangles, {}, {1, 1});
        EXPECT_TRUE(bowl.converged);
        double sum = 0;
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
            sum += std::abs(bowl.z[i] - bowl_at(mesh.nodes[i][0], mesh.nodes[i][1]));
        EXPECT_LT(sum / static_cast<double>(mesh.nodes.size()), 0.3) << power;
    }
}

TEST(Dsi, EqualNodesAndBoundsAreMetToTheLastDigit) {
    const Lattice mesh = lattice(30, 20);
    const Points points = on(mesh, 20, [](double x, double y) { return std::sin(x / 3) + y / 5; });
    const DsiHeights free = dsi(points, mesh.nodes, mesh.triangles, {}, {0, 1});
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const auto& p : points) {
        low = std::min(low, p[2] - 0.001);
        high = std::max(high, p[2] + 0.001);
    }
    ASSERT_LT(*std::min_element(free.z.begin(), free.z.end()), low - 0.1);
    ASSERT_GT(*std::max_element(free.z.begin(), free.z.end()), high + 0.1);
    Vector equal(mesh.nodes.size(), std::nan("")), least(mesh.nodes.size(), low),
        most(mesh.nodes.size(), high);
    equal[17] = free.z[17] < high ? 0.5 * (low + high) : high;
    const DsiHeights found = dsi(points, mesh.nodes, mesh.triangles, {equal, least, most}, {0, 1});
    EXPECT_EQ(found.z[17], equal[17]);
    EXPECT_EQ(*std::min_element(found.z.begin(), found.z.end()), low);
    EXPECT_EQ(*std::max_element(found.z.begin(), found.z.end()), high);
    EXPECT_LT(found.misfit, 2e-3);
}

TEST(Dsi, SameBytesForAnyNumberOfThreads) {
    const Lattice mesh = lattice(300, 260);
    const Points points =
        on(mesh, 400, [](double x, double y) { return std::sin(x / 30) * std::cos(y / 20); });
    const DsiHeights one = dsi(points, mesh.nodes, mesh.triangles, {}, {1, 1});
    const DsiHeights three = dsi(points, mesh.nodes, mesh.triangles, {}, {1, 3});
    EXPECT_EQ(std::memcmp(one.z.data(), three.z.data(), 8 * one.z.size()), 0);
}

TEST(Dsi, RefusesAndStops) {
    const Lattice mesh = lattice(5, 5);
    const Points points{{1, 1, 0}, {2, 3, 1}};
    const auto kind = [&](const Points& of, const NodeConstraints& c, const DsiOptions& options) {
        try {
            dsi(of, mesh.nodes, mesh.triangles, c, options);
        } catch (const InputError& error) {
            return error.kind;
        }
        return std::string("accepted");
    };
    EXPECT_EQ(kind(points, {}, {}), "accepted");
    EXPECT_EQ(kind({}, {}, {}), "no_points");
    EXPECT_EQ(kind({{-9, -9, 1}}, {}, {}), "no_points");
    EXPECT_EQ(kind({{1, 1, 1}, {1, 1, 2}}, {}, {}), "contradicting_points");
    EXPECT_EQ(kind(points, {}, {-1, 0}), "option");
    const Vector two(2, 0.0), infinite(25, HUGE_VAL), low(25, 0.0), high(25, 1.0);
    EXPECT_EQ(kind(points, {two, {}, {}}, {}), "option");
    EXPECT_EQ(kind(points, {infinite, {}, {}}, {}), "not_finite");
    EXPECT_EQ(kind(points, {{}, high, low}, {}), "option");
    EXPECT_EQ(kind({}, {low, {}, {}}, {}), "accepted");
    EXPECT_THROW(dsi(points, mesh.nodes, {}, {}, {}), InputError);
    const std::vector<std::array<std::int32_t, 3>> bad{{0, 1, 25}};
    EXPECT_THROW(dsi(points, mesh.nodes, bad, {}, {}), InputError);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(dsi(points, mesh.nodes, mesh.triangles, {}, {}, &progress), Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
