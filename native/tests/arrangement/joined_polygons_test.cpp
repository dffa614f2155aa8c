// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/joined_polygons.hpp"

#include <gtest/gtest.h>

namespace realmodel::arrangement {
namespace {

using NodeLoops = std::vector<std::vector<NodeId>>;

NodeLoops outlines(JoinedPolygons& joined) {
    NodeLoops found;
    joined.each_outline([&](std::span<const JoinedPolygons::HalfEdge> outline) {
        auto& loop = found.emplace_back();
        for (const auto& edge : outline)
            loop.push_back(edge.from);
    });
    return found;
}

JoinedPolygons joined(const NodeLoops& loops) {
    JoinedPolygons result;
    for (std::size_t i = 0; i < loops.size(); ++i)
        result.add(loops[i], static_cast<std::int32_t>(i));
    return result;
}

const auto kAlways = [](const auto&...) { return true; };

TEST(JoinedPolygons, TwoTrianglesMakeASquare) {
    JoinedPolygons square = joined({{0, 1, 2}, {0, 2, 3}});
    square.pair(kAlways);
    EXPECT_EQ(outlines(square), (NodeLoops{{0, 1, 2, 3}}));
    int pairs = 0;
    square.each_pair([&](std::int32_t p, std::int32_t q) {
        EXPECT_NE(p, q);
        ++pairs;
    });
    EXPECT_EQ(pairs, 2);
}

TEST(JoinedPolygons, WhatMayNotJoinStaysApart) {
    JoinedPolygons square = joined({{0, 1, 2}, {0, 2, 3}});
    square.pair([](const std::array<NodeId, 2>& edge, std::int32_t, std::int32_t) {
        return edge != std::array<NodeId, 2>{0, 2};
    });
    EXPECT_EQ(outlines(square), (NodeLoops{{0, 1, 2}, {0, 2, 3}}));
}

TEST(JoinedPolygons, PairsThatMayNotStayArePartedAgain) {
    JoinedPolygons fan = joined({{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
    fan.pair(kAlways);
    fan.part([](std::int32_t p, std::int32_t q) { return p < 2 && q < 2; });
    EXPECT_EQ(outlines(fan), (NodeLoops{{0, 1, 2, 3}, {0, 3, 4}}));
}

TEST(JoinedPolygons, ARingOfPolygonsHasTwoOutlines) {
    JoinedPolygons ring =
        joined({{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});  // around 4, 5, 6, 7
    ring.pair(kAlways);
    EXPECT_EQ(outlines(ring), (NodeLoops{{0, 1, 2, 3}, {5, 4, 7, 6}}));
}

TEST(JoinedPolygons, OthersComeAfterClear) {
    JoinedPolygons one = joined({{0, 1, 2}, {0, 2, 3}});
    one.pair(kAlways);
    one.clear();
    one.add(std::vector<NodeId>{7, 8, 9}, 0);
    one.pair(kAlways);
    EXPECT_EQ(outlines(one), (NodeLoops{{7, 8, 9}}));
}

}  // namespace
}  // namespace realmodel::arrangement
