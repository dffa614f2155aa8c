// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/convex_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../dense_kriging.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

TEST(ConvexHull, OfASquareByHand) {
    const ConvexHull square({{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}, {1, 0}, {2, 1}, {0, 0}});
    for (const auto& inside : Nodes{{0, 0}, {1, 0}, {2, 1}, {0, 1}, {1, 2}, {1, 1}})
        EXPECT_TRUE(square.contains(inside));
    const double above = std::nextafter(2.0, 3.0);
    for (const auto& outside : Nodes{{-1e-300, 1}, {1, -1e-300}, {1, above}, {above, 1}, {3, 3}})
        EXPECT_FALSE(square.contains(outside));
}

TEST(ConvexHull, WithoutArea) {
    const ConvexHull nothing({}), point({{3, 4}}), line({{0, 0}, {3, 1}, {6, 2}}),
        upright({{1, 0}, {1, 5}, {1, 2}});
    EXPECT_FALSE(nothing.contains({0, 0}));
    EXPECT_TRUE(point.contains({3, 4}));
    EXPECT_FALSE(point.contains({3, 5}));
    EXPECT_TRUE(line.contains({3, 1}));
    EXPECT_FALSE(line.contains({3, std::nextafter(1.0, 2.0)}));
    EXPECT_FALSE(line.contains({9, 3}));
    EXPECT_TRUE(upright.contains({1, 4}));
    EXPECT_FALSE(upright.contains({1, 6}));
    EXPECT_FALSE(upright.contains({2, 4}));
}

TEST(ConvexHull, IsWhatLiesLeftOfEveryLineThatHasAllPointsOnItsLeft) {
    const Points points = hills(60, 10, {4e5, 5e6});
    Nodes positions;
    for (const auto& p : points)
        positions.push_back({p[0], p[1]});
    const Nodes nodes = scattered_nodes(500, 20, {4e5 - 5, 5e6 - 5});
    std::vector<std::uint8_t> expected(nodes.size(), 0);
    for (const auto& a : positions) {
        for (const auto& b : positions) {
            if (a == b) continue;
            const bool is_border =
                std::all_of(positions.begin(), positions.end(),
                            [&](const auto& p) { return exact::orient2d(a, b, p) >= 0; });
            if (!is_border) continue;
            for (std::size_t i = 0; i < nodes.size(); ++i)
                expected[i] |= exact::orient2d(a, b, nodes[i]) < 0 ? 1 : 0;
        }
    }
    EXPECT_EQ(outside_hull(points, nodes, {1}), expected);
    EXPECT_NE(std::count(expected.begin(), expected.end(), 0), 0);
    for (const std::uint8_t outside : outside_hull(points, positions, {0}))
        EXPECT_EQ(outside, 0);
    EXPECT_EQ(outside_hull(points, Nodes{{0, 0}}, {1}), (std::vector<std::uint8_t>{1}));
    EXPECT_THROW(outside_hull(points, Nodes{{std::nan(""), 0}}, {1}), InputError);
}

TEST(ConvexHull, ItsBorder) {
    Nodes lattice;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 3; ++j)
            lattice.push_back({1.0 * j, 1.0 * i});
    }
    EXPECT_EQ(hull_border(lattice), (std::vector<std::int32_t>{0, 1, 2, 5, 8, 11, 10, 9, 6, 3}));
    EXPECT_EQ(hull_border(Nodes{{2, 2}, {0, 0}, {1, 1}}), (std::vector<std::int32_t>{1, 2, 0}));
    EXPECT_EQ(hull_border(Nodes{{2, 2}}), (std::vector<std::int32_t>{0}));
    EXPECT_TRUE(hull_border({}).empty());
}

}  // namespace
}  // namespace realmodel::interpolation
