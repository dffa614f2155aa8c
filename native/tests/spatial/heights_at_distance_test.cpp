// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "../sanitized.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/spatial/queries.hpp"

namespace realmodel::spatial {
namespace {

using Plan = std::array<double, 2>;

/// A sheet over the square from -size to size.
std::vector<SpaceTriangle> sheet(const std::function<double(double, double)>& height, double size,
                                 int parts) {
    std::vector<SpaceTriangle> found;
    const auto at = [&](int i, int j) {
        const double x = size * (2.0 * i / parts - 1), y = size * (2.0 * j / parts - 1);
        return std::array{x, y, height(x, y)};
    };
    for (int i = 0; i < parts; ++i) {
        for (int j = 0; j < parts; ++j) {
            found.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            found.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return found;
}

/// The height of a sheet in plan.
double height(const std::vector<SpaceTriangle>& triangles, const Plan& at) {
    for (const auto& [a, b, c] : triangles) {
        const auto turn = [&at](const auto& p, const auto& q) {
            return (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
        };
        const std::array shares{turn(b, c), turn(c, a), turn(a, b)};
        if (std::ranges::min(shares) < 0) continue;
        const double all = shares[0] + shares[1] + shares[2];
        return (shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2]) / all;
    }
    return std::nan("");
}

double nearest(const std::vector<SpaceTriangle>& triangles, const Plan& at, double z) {
    const std::array<double, 3> p{at[0], at[1], z};
    return nearest_triangles(triangles, {&p, 1}, HUGE_VAL, {.threads = 1}).distance[0];
}

TEST(HeightsAtDistance, OverAPlaneAreAllAtOneHeightAboveIt) {
    const double slope = std::sqrt(3.0);  // 60 degrees
    const auto plane = [&](double x, double y) { return slope * (0.6 * x + 0.8 * y); };
    const auto triangles = sheet(plane, 10, 7);
    std::vector<Plan> places;
    std::vector<double> own;
    for (const double x : {-3.0, -0.5, 0.0, 1.7, 3.0}) {
        places.push_back({x, 1 - x});
        own.push_back(plane(x, 1 - x));
    }
    const std::vector<double> away(places.size(), 2.0);
    const auto found = heights_at_distance(triangles, places, own, away);
    for (std::size_t i = 0; i < places.size(); ++i)
        EXPECT_NEAR(found[i], own[i] + 4, 1e-12);
}

/// Over an edge they are those of a tube, over a corner those of a sphere.
TEST(HeightsAtDistance, OverARidgeAndAPeakAreRound) {
    const auto ridge = sheet([](double x, double) { return -2 * std::abs(x); }, 8, 4);
    const auto over_ridge = heights_at_distance(ridge, {{{0.5, 0.3}}}, {{-1.0}}, {{1.0}});
    EXPECT_NEAR(over_ridge[0], std::sqrt(0.75), 1e-14);
    const auto peak =
        sheet([](double x, double y) { return -3 * std::max(std::abs(x), std::abs(y)); }, 8, 2);
    const auto over_peak = heights_at_distance(peak, {{{0.2, 0.1}}}, {{-0.6}}, {{1.0}});
    EXPECT_NEAR(over_peak[0], std::sqrt(0.95), 1e-14);
}

TEST(HeightsAtDistance, NoTriangleIsNearerAndOneIsAsNear) {
    std::mt19937 source{11};
    std::uniform_real_distribution<double> number(-1, 1);
    for (int round = 0; round < (kSanitized ? 6 : 30); ++round) {
        const double far = round % 3 == 0 ? 1e6 : 0;  // coordinates of a national grid
        const double steep = 0.2 * (round % 7 + 1);
        auto triangles =
            sheet([&](double x, double y) { return steep * std::sin(37 * x + 91 * y * y + round); },
                  4, 16);
        for (SpaceTriangle& triangle : triangles) {
            for (auto& corner : triangle)
                corner[0] += far;
        }
        std::vector<Plan> places(40);
        std::vector<double> own(40), away(40);
        for (std::size_t i = 0; i < places.size(); ++i) {
            places[i] = {far + number(source), number(source)};
            away[i] = 0.05 + 1.2 * std::abs(number(source));
            own[i] = height(triangles, places[i]);
        }
        const auto found = heights_at_distance(triangles, places, own, away, {.threads = 1});
        EXPECT_EQ(found, heights_at_distance(triangles, places, own, away, {.threads = 3}));
        for (std::size_t i = 0; i < places.size(); ++i) {
            EXPECT_NEAR(nearest(triangles, places[i], found[i]), away[i], 1e-9);
            EXPECT_GT(nearest(triangles, places[i], found[i] + 1e-3), away[i]);
            EXPECT_GT(nearest(triangles, places[i], found[i] + 0.7 * away[i]), away[i]);
        }
    }
}

TEST(HeightsAtDistance, WhereThereIsNone) {
    const auto flat = sheet([](double, double) { return 1.0; }, 2, 2);
    const std::vector<Plan> places{{0, 0}, {0.5, 0}, {1, 1}};
    const auto found = heights_at_distance(flat, places, {{std::nan(""), 1.0, 1.0}}, {{1, 0, 0.5}});
    EXPECT_TRUE(std::isnan(found[0]));
    EXPECT_EQ(found[1], 1.0);
    EXPECT_EQ(found[2], 1.5);
    EXPECT_THROW(heights_at_distance(flat, places, {{1.0}}, {{1.0, 1.0, 1.0}}), InputError);
}

}  // namespace
}  // namespace realmodel::spatial
