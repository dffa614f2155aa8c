// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "../dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {
namespace {

using Method = std::vector<double> (*)(std::span<const std::array<double, 3>>,
                                       std::span<const std::array<double, 2>>, const Execution&);
constexpr std::array<Method, 2> methods{linear_on_triangulation, natural_neighbors};

TEST(Triangulated, ByHand) {
    const Points square{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 8}};
    EXPECT_DOUBLE_EQ(linear_on_triangulation(square, Nodes{{1, 0.5}}, {1})[0], 4);
    // The node in the middle of a square of four equal cells takes a quarter from each.
    const Points corners{{0, 0, 1}, {2, 0, 2}, {2, 2, 3}, {0, 2, 6}};
    EXPECT_NEAR(natural_neighbors(corners, Nodes{{1, 1}}, {1})[0], 3, 1e-14);
}

/// The node is inside the hull by rounding alone: the center of a circle through it is nowhere.
TEST(Triangulated, IsFiniteNextToTheHull) {
    const Points points{{0.8, 0.6, 0.0},  {0.8, 1.0, 0.1},  {1.0, 0.6, 0.0},  {1.0, 0.8, 0.0},
                        {0.0, 0.0, -0.1}, {0.0, 0.2, -0.1}, {0.2, 0.0, -0.1}, {0.2, 0.2, -0.1},
                        {0.4, 0.0, -0.1}, {0.6, 0.2, -0.1}, {1.0, 0.0, -0.1}, {1.0, 0.2, 0.0}};
    EXPECT_NEAR(natural_neighbors(points, Nodes{{0.4, 0.6}}, {1})[0], 0, 1e-14);
}

TEST(Triangulated, SameBytesForAnyNumberOfThreads) {
    Points points = hills(800, 100, {4e5, 5e6});
    for (int i = 0; i < 400; ++i)  // a lattice: ties everywhere
        points.push_back({4e5 + 5.0 * (i % 20), 5e6 + 5.0 * (i / 20), 1.0 * (i % 7)});
    const Nodes nodes = scattered_nodes(3000, 120, {4e5 - 10, 5e6 - 10});
    for (const Method method : methods) {
        const auto one = method(points, nodes, {1, nullptr}),
                   three = method(points, nodes, {3, nullptr});
        EXPECT_EQ(std::memcmp(one.data(), three.data(), 8 * nodes.size()), 0);
    }
}

TEST(Triangulated, RefusesAndStops) {
    for (const Method method : methods) {
        EXPECT_THROW(method({}, Nodes{{0, 0}}, {1, nullptr}), InputError);
        EXPECT_THROW(method(Points{{0, 0, 1}, {0, 0, 2}}, Nodes{{0, 0}}, {1, nullptr}), InputError);
        EXPECT_THROW(method(Points{{0, 0, 1}}, Nodes{{HUGE_VAL, 0}}, {1, nullptr}), InputError);
        Progress progress;
        progress.cancel();
        EXPECT_THROW(method(hills(5000, 10), scattered_nodes(9, 10), {0, &progress}), Cancelled);
    }
}

}  // namespace
}  // namespace realmodel::interpolation
