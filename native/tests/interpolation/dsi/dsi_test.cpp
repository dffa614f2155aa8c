// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/dsi.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>

#include "../dense_kriging.hpp"
#include "interpolation/dsi/vectors.hpp"
#include "lattice.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

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

TEST(Dsi, SameBytesForAnyNumberOfThreads) {
    const Lattice mesh = lattice(300, 260);
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
