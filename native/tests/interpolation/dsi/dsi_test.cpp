// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/dsi.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>

#include "../../sanitized.hpp"
#include "../dense_kriging.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/dsi/wavefront_sweep.hpp"
#include "lattice.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "spatial/mesh_locator.hpp"

namespace realmodel::interpolation {
namespace {

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
            if (kSanitized && side > 100) continue;
            const Lattice mesh = lattice(side, side);
            const auto height = [&](double x, double y) {
                return 100 * std::sin(5 * x / side) * std::cos(4 * y / side);
            };
            const DsiHeights found =
                dsi(on(mesh, 150, height), mesh.nodes, mesh.triangles, {}, weight, {1});
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
            dsi(on(mesh, 60, plane_at), mesh.nodes, mesh.triangles, {}, 0, {1});
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
            EXPECT_NEAR(plane.z[i], plane_at(mesh.nodes[i][0], mesh.nodes[i][1]), 1e-9);
        const auto bowl_at = [](double x, double y) { return 0.01 * (x * x + y * y); };
        const DsiHeights bowl = dsi(on(mesh, 60, bowl_at), mesh.nodes, mesh.triangles, {}, 1, {1});
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
    const DsiHeights free = dsi(points, mesh.nodes, mesh.triangles, {}, 0, {1});
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
    const DsiHeights found = dsi(points, mesh.nodes, mesh.triangles, {equal, least, most}, 0, {1});
    EXPECT_EQ(found.z[17], equal[17]);
    EXPECT_EQ(*std::min_element(found.z.begin(), found.z.end()), low);
    EXPECT_EQ(*std::max_element(found.z.begin(), found.z.end()), high);
    EXPECT_LT(found.misfit, 2e-3);
}

/// Height at a position, of heights of a lattice's nodes.
double height_at(const Lattice& mesh, const std::vector<double>& z, const PlanPosition& at) {
    const auto found = spatial::MeshLocator(mesh.nodes, mesh.triangles).find(at);
    double sum = 0;
    for (std::size_t k = 0; found && k < 3; ++k)
        sum += found->weights[k] * z[mesh.triangles[found->triangle][k]];
    return found ? sum : std::nan("");
}

TEST(Dsi, TrianglesHaveTheirDips) {
    const Lattice mesh = lattice(30, 20);
    const Points points = on(mesh, 12, [](double x, double y) { return std::sin(x / 3) + y / 5; });
    const Nodes positions{{4.3, 5.6}, {22.7, 11.2}, {15.1, 3.4}, {-3, 2}};
    const Nodes slopes{{0.5, -0.2}, {0, 0.3}, {-0.4, 0}, {9, 9}};
    DsiConstraints constraints;
    constraints.dips = {positions, slopes, 1, 0};
    const DsiHeights found = dsi(points, mesh.nodes, mesh.triangles, constraints, 0, {1});
    EXPECT_EQ(found.dips_outside, 1);
    EXPECT_EQ(found.dips_missed, 0);
    EXPECT_EQ(found.missed, 0);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            PlanPosition to = positions[i], from = to;
            to[axis] += 1e-3;
            from[axis] -= 1e-3;
            const double rise = height_at(mesh, found.z, to) - height_at(mesh, found.z, from);
            EXPECT_NEAR(rise / 2e-3, slopes[i][axis], 1e-5);
        }
    }
    // Two slopes of one triangle.
    const Nodes twice{positions[0], positions[0]}, both{{0.5, 0}, {0.7, 0}};
    constraints.dips = {twice, both, 1, 0};
    EXPECT_GT(dsi(points, mesh.nodes, mesh.triangles, constraints, 0, {1}).dips_missed, 0);
    constraints.dips = {positions, both, 1, 0};
    EXPECT_THROW(dsi(points, mesh.nodes, mesh.triangles, constraints, 0), InputError);
}

TEST(Dsi, OnePointAndDipsMakeAPlane) {
    const Lattice mesh = lattice(30, 20);
    const Nodes positions{{4.3, 5.6}, {22.7, 11.2}}, slopes{{0.5, -0.2}, {0.5, -0.2}};
    DsiConstraints constraints;
    constraints.dips = {positions, slopes, 1, 0};
    const Points point{{10, 10, 100}};
    for (const double weight : {0.0, 1.0}) {
        const DsiHeights found = dsi(point, mesh.nodes, mesh.triangles, constraints, weight, {1});
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
            const auto& [x, y] = mesh.nodes[i];
            EXPECT_NEAR(found.z[i], 100 + 0.5 * (x - 10) - 0.2 * (y - 10), 1e-9);
        }
    }
}

TEST(Dsi, BoundsHoldWithinTriangles) {
    const Lattice mesh = lattice(30, 20);
    const Points points = on(mesh, 12, [](double x, double y) { return std::sin(x / 3) + y / 5; });
    const DsiHeights free = dsi(points, mesh.nodes, mesh.triangles, {}, 0, {1});
    Points lower, upper;
    for (const PlanPosition& p : {PlanPosition{4.3, 5.6}, {22.7, 11.2}, {15.1, 3.4}, {8.8, 17.3}}) {
        const double z = height_at(mesh, free.z, p);
        lower.push_back({p[0], p[1], z + 0.5});
        upper.push_back({p[0] + 1, p[1] + 1, height_at(mesh, free.z, {p[0] + 1, p[1] + 1}) - 0.1});
    }
    lower.push_back({-5, -5, 99});  // outside
    DsiConstraints constraints;
    constraints.lower = lower;
    constraints.upper = upper;
    const DsiHeights found = dsi(points, mesh.nodes, mesh.triangles, constraints, 0, {1});
    EXPECT_EQ(found.bounds_missed, 0);
    for (std::size_t i = 0; i + 1 < lower.size(); ++i) {
        EXPECT_GE(height_at(mesh, found.z, {lower[i][0], lower[i][1]}), lower[i][2]);
        EXPECT_LE(height_at(mesh, found.z, {upper[i][0], upper[i][1]}), upper[i][2]);
    }
    upper = {{4.3, 5.6, lower[0][2] - 1}};
    constraints.upper = upper;
    EXPECT_GT(dsi(points, mesh.nodes, mesh.triangles, constraints, 0, {1}).bounds_missed, 0);
    upper = {{4.3, 5.6, std::nan("")}};
    constraints.upper = upper;
    EXPECT_THROW(dsi(points, mesh.nodes, mesh.triangles, constraints, 0), InputError);
}

TEST(Dsi, SameBytesForAnyNumberOfThreads) {
    const Lattice mesh = kSanitized ? lattice(150, 130) : lattice(300, 260);
    const Points points =
        on(mesh, 400, [](double x, double y) { return std::sin(x / 30) * std::cos(y / 20); });
    const DsiHeights one = dsi(points, mesh.nodes, mesh.triangles, {}, 1, {1});
    const DsiHeights three = dsi(points, mesh.nodes, mesh.triangles, {}, 1, {3});
    EXPECT_EQ(std::memcmp(one.z.data(), three.z.data(), 8 * one.z.size()), 0);
}

TEST(Dsi, RefusesAndStops) {
    const Lattice mesh = lattice(5, 5);
    const Points points{{1, 1, 0}, {2, 3, 1}};
    const auto kind = [&](const Points& of, const DsiConstraints& c, double weight) {
        try {
            dsi(of, mesh.nodes, mesh.triangles, c, weight);
        } catch (const InputError& error) {
            return error.kind;
        }
        return std::string("accepted");
    };
    EXPECT_EQ(kind(points, {}, 0), "accepted");
    EXPECT_EQ(kind({}, {}, 0), "no_points");
    EXPECT_EQ(kind({{-9, -9, 1}}, {}, 0), "no_points");
    EXPECT_EQ(kind({{1, 1, 1}, {1, 1, 2}}, {}, 0), "contradicting_points");
    EXPECT_EQ(kind(points, {}, -1), "option");
    const Vector two(2, 0.0), infinite(25, HUGE_VAL), low(25, 0.0), high(25, 1.0);
    EXPECT_EQ(kind(points, {two, {}, {}}, 0), "option");
    EXPECT_EQ(kind(points, {infinite, {}, {}}, 0), "not_finite");
    EXPECT_EQ(kind(points, {{}, high, low}, 0), "option");
    EXPECT_EQ(kind({}, {low, {}, {}}, 0), "accepted");
    EXPECT_THROW(dsi(points, mesh.nodes, {}, {}, 0), InputError);
    const std::vector<std::array<std::int32_t, 3>> bad{{0, 1, 25}};
    EXPECT_THROW(dsi(points, mesh.nodes, bad, {}, 0), InputError);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(dsi(points, mesh.nodes, mesh.triangles, {}, 0, {0, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
