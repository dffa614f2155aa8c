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

TEST(MeshLocator, Refuses) {
    const std::vector<std::array<double, 2>> vertices{{0, 0}, {1, 0}, {0, 1}};
    const std::vector<std::array<std::int32_t, 3>> bad{{0, 1, 3}};
    EXPECT_THROW(MeshLocator(vertices, bad), InputError);
    const std::vector<std::array<double, 2>> infinite{{0, 0}, {HUGE_VAL, 0}, {0, 1}};
    EXPECT_THROW(MeshLocator(infinite, {}), InputError);
}

}  // namespace
}  // namespace realmodel::spatial
