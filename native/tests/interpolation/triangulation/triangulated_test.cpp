// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "../dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/convex_hull.hpp"

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

using PartMethod = SubsetValues (*)(std::span<const std::array<double, 3>>,
                                    std::span<const std::array<double, 2>>, const PointsAround&,
                                    const Execution&);
constexpr std::array<PartMethod, 2> part_methods{linear_on_subset, natural_neighbors_of_subset};

/// Of hills and of a lattice, the nodes also on points, on edges, on the hull and beside it.
TEST(Triangulated, APartKnowsWhereItSuffices) {
    const std::array<double, 2> origin{4e5, 5e6};
    Points lattice;
    for (int i = 0; i < 900; ++i)
        lattice.push_back({4e5 + 4.0 * (i * 7 % 30), 5e6 + 4.0 * (i / 30), 1.0 * (i * i % 11)});
    Nodes nodes = scattered_nodes(400, 140, {4e5 - 10, 5e6 - 10});
    for (int i = 0; i < 400; ++i)
        nodes.push_back({4e5 + 2.0 * (i % 20), 5e6 + 6.0 * (i / 20)});
    for (const Points& points : {hills(900, 120, origin), lattice}) {
        PointsAround around;
        Nodes local;
        around.all = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        for (const auto& [x, y, z] : points) {
            local.push_back({x - points[0][0], y - points[0][1]});
            around.all = {std::min(around.all[0], x), std::min(around.all[1], y),
                          std::max(around.all[2], x), std::max(around.all[3], y)};
        }
        Points border;
        for (const std::int32_t i : hull_border(local))
            border.push_back(points[static_cast<std::size_t>(i)]);
        around.border = border;
        around.window = {4e5 - 20, 5e6 - 20, 4e5 + 70, 5e6 + 90};
        Points part;
        for (const auto& p : points) {
            if (p == points[0] || (p[0] <= around.window[2] && p[1] <= around.window[3]))
                part.push_back(p);
        }
        ASSERT_LT(part.size(), points.size() * 3 / 4);
        for (std::size_t k = 0; k < methods.size(); ++k) {
            const std::vector<double> expected = methods[k](points, nodes, {1, nullptr});
            const SubsetValues found = part_methods[k](part, nodes, around, {1, nullptr});
            std::size_t in_middle = 0, certain = 0;
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                if (found.certain[i] != 0) {
                    EXPECT_EQ(found.z[i], expected[i]);
                }
                if (nodes[i][0] > 4e5 + 40 || nodes[i][1] > 5e6 + 60) continue;
                ++in_middle;
                certain += found.certain[i];
            }
            EXPECT_EQ(certain, in_middle);
            PointsAround whole = around;
            whole.is_whole = true;
            const SubsetValues of_all = part_methods[k](points, nodes, whole, {1, nullptr});
            EXPECT_EQ(of_all.z, expected);
            EXPECT_EQ(std::count(of_all.certain.begin(), of_all.certain.end(), 1), 800);
        }
    }
}

}  // namespace
}  // namespace realmodel::interpolation
