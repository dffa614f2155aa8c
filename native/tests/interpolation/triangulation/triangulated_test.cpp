// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "../dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/mesh_locator.hpp"

namespace realmodel::interpolation {
namespace {

using Method = std::vector<double> (*)(std::span<const std::array<double, 3>>,
                                       std::span<const std::array<double, 2>>, int, Progress*);
constexpr std::array<Method, 2> methods{linear_on_triangulation, natural_neighbors};

TEST(Triangulated, ByHand) {
    const Points square{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 8}};
    EXPECT_DOUBLE_EQ(linear_on_triangulation(square, Nodes{{1, 0.5}}, 1)[0], 4);
    // The node in the middle of a square of four equal cells takes a quarter from each.
    const Points corners{{0, 0, 1}, {2, 0, 2}, {2, 2, 3}, {0, 2, 6}};
    EXPECT_NEAR(natural_neighbors(corners, Nodes{{1, 1}}, 1)[0], 3, 1e-14);
}

TEST(Triangulated, SameBytesForAnyNumberOfThreads) {
    Points points = hills(800, 100, {4e5, 5e6});
    for (int i = 0; i < 400; ++i)  // a lattice: ties everywhere
        points.push_back({4e5 + 5.0 * (i % 20), 5e6 + 5.0 * (i / 20), 1.0 * (i % 7)});
    const Nodes nodes = scattered_nodes(3000, 120, {4e5 - 10, 5e6 - 10});
    for (const Method method : methods) {
        const auto one = method(points, nodes, 1, nullptr),
                   three = method(points, nodes, 3, nullptr);
        EXPECT_EQ(std::memcmp(one.data(), three.data(), 8 * nodes.size()), 0);
    }
}

TEST(Triangulated, RefusesAndStops) {
    for (const Method method : methods) {
        EXPECT_THROW(method({}, Nodes{{0, 0}}, 1, nullptr), InputError);
        EXPECT_THROW(method(Points{{0, 0, 1}, {0, 0, 2}}, Nodes{{0, 0}}, 1, nullptr), InputError);
        EXPECT_THROW(method(Points{{0, 0, 1}}, Nodes{{HUGE_VAL, 0}}, 1, nullptr), InputError);
        Progress progress;
        progress.cancel();
        EXPECT_THROW(method(hills(5000, 10), scattered_nodes(9, 10), 0, &progress), Cancelled);
    }
}

TEST(MeshLocator, FindsWhatEveryTriangleSays) {
    // A fan about a point, turning both ways, and a triangle far off.
    const std::vector<std::array<double, 2>> vertices{{0, 0},  {4, 0},   {4, 3},   {0, 5},
                                                      {-3, 1}, {50, 50}, {51, 50}, {50, 51}};
    const std::vector<std::array<std::int32_t, 3>> triangles{
        {0, 1, 2}, {0, 3, 2}, {0, 3, 4}, {5, 6, 7}, {5, 5, 6}};
    const MeshLocator locator(vertices, triangles);
    EXPECT_EQ(locator.find({3, 1})->triangle, 0);
    EXPECT_EQ(locator.find({1, 2})->triangle, 1);
    EXPECT_EQ(locator.find({-1, 1})->triangle, 2);
    EXPECT_EQ(locator.find({50.2, 50.2})->triangle, 3);
    EXPECT_EQ(locator.find({2, 1.5})->triangle, 0);  // on the edge of two
    EXPECT_FALSE(locator.find({20, 20}));
    EXPECT_FALSE(locator.find({4.1, 1}));
    const auto found = locator.find({2, 1});
    double x = 0, y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(triangles[0][k]);
        x += found->weights[k] * vertices[v][0];
        y += found->weights[k] * vertices[v][1];
    }
    EXPECT_NEAR(x, 2, 1e-15);
    EXPECT_NEAR(y, 1, 1e-15);
}

TEST(MeshLocator, EveryVertexIsFoundAtUtmCoordinates) {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<double, 2>> positions;
    std::vector<std::array<std::int32_t, 3>> triangles;
    constexpr int n = 40;
    for (int i = 0; i < n * n; ++i) {
        vertices.push_back({431250.1 + 0.3 * (i % n), 5398781.7 + 0.7 * (i / n), 1.0 * i});
        positions.push_back({vertices.back()[0], vertices.back()[1]});
        if (i % n == n - 1 || i / n == n - 1) continue;
        triangles.push_back({i, i + 1, i + n});
        triangles.push_back({i + 1, i + n + 1, i + n});
    }
    const std::vector<double> z = heights_on_surface(vertices, triangles, positions, 0);
    for (std::size_t i = 0; i < z.size(); ++i)
        EXPECT_NEAR(z[i], vertices[i][2], 1e-6);
    EXPECT_TRUE(std::isnan(heights_on_surface(vertices, triangles, Nodes{{0, 0}}, 1)[0]));
    EXPECT_TRUE(std::isnan(heights_on_surface(vertices, {}, Nodes{{0, 0}}, 1)[0]));
}

TEST(MeshLocator, Refuses) {
    const std::vector<std::array<double, 2>> vertices{{0, 0}, {1, 0}, {0, 1}};
    const std::vector<std::array<std::int32_t, 3>> bad{{0, 1, 3}};
    EXPECT_THROW(MeshLocator(vertices, bad), InputError);
    const std::vector<std::array<double, 2>> infinite{{0, 0}, {HUGE_VAL, 0}, {0, 1}};
    EXPECT_THROW(MeshLocator(infinite, {}), InputError);
}

}  // namespace
}  // namespace realmodel::interpolation
