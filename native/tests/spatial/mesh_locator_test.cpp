// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/mesh_locator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::spatial {
namespace {

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

TEST(MeshLocator, FindsTheSameInABoxThatIsAsked) {
    std::vector<std::array<double, 2>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    for (int x = 0; x < 12; ++x) {
        for (int y = 0; y < 12; ++y) {
            vertices.push_back({x + 0.3 * (y % 2), 1.0 * y});
            if (x == 0 || y == 0) continue;
            const std::int32_t at = 12 * x + y;
            triangles.push_back({at - 13, at - 1, at});
            triangles.push_back({at, at - 12, at - 13});
        }
    }
    const MeshLocator all(vertices, triangles);
    const PlanBox asked{3, 4, 5.25, 9};
    const MeshLocator some(vertices, triangles, asked);
    for (double x = asked.low_x; x <= asked.high_x; x += 0.25) {
        for (double y = asked.low_y; y <= asked.high_y; y += 0.25) {
            ASSERT_TRUE(all.find({x, y}));
            EXPECT_EQ(some.find({x, y})->triangle, all.find({x, y})->triangle);
        }
    }
    EXPECT_FALSE(MeshLocator(vertices, triangles, kNoBox).find({4, 4}));
}

TEST(MeshLocator, Refuses) {
    const std::vector<std::array<double, 2>> vertices{{0, 0}, {1, 0}, {0, 1}};
    const std::vector<std::array<std::int32_t, 3>> bad{{0, 1, 3}};
    EXPECT_THROW(MeshLocator(vertices, bad), InputError);
    const std::vector<std::array<double, 2>> infinite{{0, 0}, {HUGE_VAL, 0}, {0, 1}};
    EXPECT_THROW(MeshLocator(infinite, {}), InputError);
}

}  // namespace
}  // namespace realmodel::spatial
