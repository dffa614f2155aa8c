// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "arrangement/triangulate.hpp"
#include "small_polygons.hpp"

namespace realmodel::arrangement {
namespace {

constexpr PlanePosition kNoRounding{0, 0}, kTenth{0.1, 0.1};

/// Nodes from 0 on at some positions.
Loop numbered(const std::vector<PlanePosition>& positions) {
    Loop loop;
    for (std::size_t i = 0; i < positions.size(); ++i)
        loop.push_back({NodeId{static_cast<int>(i)}, positions[i]});
    return loop;
}

std::vector<NodeLoop> divided(const Loop& loop, const PlanePosition& rounding,
                              std::vector<std::array<NodeId, 2>> slits = {}) {
    Polygons polygons;
    EXPECT_TRUE(divide_convex({&loop, 1}, rounding, slits, polygons));
    return loops_of(polygons);
}

TEST(ConvexDivision, ALoopThatTurnsLeftOrGoesStraightOnIsConvex) {
    EXPECT_TRUE(is_convex(numbered({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}), kNoRounding));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {0, 2}, {2, 2}, {2, 0}}), kNoRounding));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {2, 0}}), kNoRounding));
}

TEST(ConvexDivision, ADentCountsWhereItIsDeeperThanRounding) {
    // 2 x depth against 0.1 x the way along either axis, which is 3 in all
    EXPECT_TRUE(is_convex(numbered({{0, 0}, {1, 0.64}, {2, 1}, {0, 3}}), kTenth));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {1, 0.66}, {2, 1}, {0, 3}}), kTenth));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {1, 0.51}, {2, 1}, {0, 3}}), kNoRounding));
}

TEST(ConvexDivision, AShortEdgeHidesNoTurn) {
    // a strip with a bend, on the inner side of which an edge is hardly longer than rounding
    const Loop strip =
        numbered({{0, 0}, {0.5, -3.4}, {1.5e-5, 0}, {1e-5, 0}, {-0.099, 1.9}, {-0.8, 15.2}});
    constexpr PlanePosition kRounding{1e-6, 4e-3};
    EXPECT_FALSE(is_convex(strip, kRounding));
    EXPECT_EQ(divided(strip, kRounding).size(), 2U);
}

TEST(ConvexDivision, WhatWindsRoundTwiceIsNotConvex) {
    // a pentagram turns left at each of its points
    EXPECT_FALSE(is_convex(numbered({{0, 3}, {-2, -3}, {3, 1}, {-3, 1}, {2, -3}}), kNoRounding));
}

TEST(ConvexDivision, WhatPassesANodeTwiceIsNotConvex) {
    Loop loop = numbered({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
    EXPECT_TRUE(is_convex(loop, kNoRounding));
    loop.push_back(loop.back());
    EXPECT_FALSE(is_convex(loop, kNoRounding));
}

TEST(ConvexDivision, AnArrowFallsInTwoAtItsDent) {
    const auto polygons = divided(numbered({{0, 0}, {4, -2}, {3, 0}, {4, 2}}), kNoRounding);
    EXPECT_EQ(polygons, (std::vector<NodeLoop>{node_loop({0, 1, 2}), node_loop({0, 2, 3})}));
}

TEST(ConvexDivision, ADentOfRoundingIsLeftInItsPolygon) {
    const Loop loop = numbered({{0, 0}, {1, 0.09}, {2, 0}, {2, 2}, {0, 2}});
    EXPECT_EQ(divided(loop, kTenth).size(), 1U);
    EXPECT_GT(divided(loop, kNoRounding).size(), 1U);
}

TEST(ConvexDivision, TrianglesAreNotMergedAcrossASlit) {
    // beside the dent at 3 the quadrangle 0-1-2-3, whichever of its diagonals divides it first
    const Loop loop = numbered({{0, 0}, {2, -2}, {4, -2}, {3, 0}, {4, 2}});
    EXPECT_EQ(divided(loop, kNoRounding),
              (std::vector<NodeLoop>{node_loop({0, 1, 2, 3}), node_loop({0, 3, 4})}));
    EXPECT_EQ(divided(loop, kNoRounding, {{NodeId{0}, NodeId{2}}, {NodeId{1}, NodeId{3}}}).size(),
              3U);
}

}  // namespace
}  // namespace realmodel::arrangement
