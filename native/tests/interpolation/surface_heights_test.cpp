// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/surface_heights.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dense_kriging.hpp"

namespace realmodel::interpolation {
namespace {

TEST(SurfaceHeights, EveryVertexIsFoundAtUtmCoordinates) {
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
    const std::vector<double> z = heights_on_surface(vertices, triangles, positions, {0});
    for (std::size_t i = 0; i < z.size(); ++i)
        EXPECT_NEAR(z[i], vertices[i][2], 1e-6);
    EXPECT_TRUE(std::isnan(heights_on_surface(vertices, triangles, Nodes{{0, 0}}, {1})[0]));
    EXPECT_TRUE(std::isnan(heights_on_surface(vertices, {}, Nodes{{0, 0}}, {1})[0]));
}

}  // namespace
}  // namespace realmodel::interpolation
