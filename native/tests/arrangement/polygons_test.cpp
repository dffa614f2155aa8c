// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/polygons.hpp"

#include <gtest/gtest.h>

namespace realmodel::arrangement {
namespace {

using Nodes = std::vector<NodeId>;

TEST(Polygons, AreKeptOneAfterAnother) {
    Polygons polygons;
    const Nodes one{NodeId{4}, NodeId{5}, NodeId{6}},
        two{NodeId{7}, NodeId{4}, NodeId{6}, NodeId{9}};
    polygons.add(one);
    for (const NodeId node : two)
        polygons.nodes.push_back(node);
    polygons.close();
    ASSERT_EQ(polygons.size(), 2U);
    EXPECT_EQ(Nodes(polygons[0].begin(), polygons[0].end()), one);
    EXPECT_EQ(Nodes(polygons[1].begin(), polygons[1].end()), two);
    polygons.clear();
    EXPECT_EQ(polygons.size(), 0U);
    polygons.add(two);
    EXPECT_EQ(Nodes(polygons[0].begin(), polygons[0].end()), two);
}

TEST(Polygons, AnEdgeHasItsLesserNodeFirst) {
    EXPECT_EQ(unordered(NodeId{3}, NodeId{7}), unordered(NodeId{7}, NodeId{3}));
    EXPECT_EQ(unordered(NodeId{7}, NodeId{3})[0], NodeId{3});
}

const std::vector<Position> kTriangle{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};

/// The same with x, y, z as y, z, x, so often: it turns about another axis.
std::vector<Position> rolled(int times) {
    std::vector<Position> corners = kTriangle;
    for (Position& p : corners) {
        for (int i = 0; i < times; ++i)
            p = {p[2], p[0], p[1]};
    }
    return corners;
}

TEST(View, TurnsPolygonsAsTheirNormalDoes) {
    for (int times = 0; times < 3; ++times) {
        for (const bool reversed : {false, true}) {
            std::vector<Position> corners = rolled(times);
            if (reversed) std::swap(corners[1], corners[2]);
            const View view(polygon_normal(corners));
            EXPECT_EQ(view.axis(), static_cast<std::size_t>(2 + times) % 3);
            EXPECT_EQ(view.sign(), reversed ? -1 : 1);
            const auto a = view(corners[0]), b = view(corners[1]), c = view(corners[2]);
            EXPECT_EQ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), 2);
        }
    }
}

TEST(View, IsAlongTheAxisNearestToTheNormal) {
    EXPECT_EQ(View({1, -3, 2}).axis(), 1U);
    EXPECT_EQ(View({1, -3, 2}).sign(), -1);
    EXPECT_EQ(View({2, 2, 1}).axis(), 0U);
}

TEST(View, RoundingIsFourUnitsOfTheLargestCoordinateOnEachAxis) {
    const std::vector<Position> positions{{1, -4, 1000}, {0.5, 1, 2000}};
    EXPECT_EQ(View({0, 0, 1}).rounding(positions), (PlanePosition{4 * 0x1p-52, 4 * 0x1p-50}));
    EXPECT_EQ(View({0, 0, -1}).rounding(positions), (PlanePosition{4 * 0x1p-50, 4 * 0x1p-52}));
    EXPECT_EQ(rounding_of(positions), 4 * 0x1p-42);
}

TEST(PolygonNormal, IsTwiceTheAreaLong) {
    EXPECT_EQ(polygon_normal(kTriangle), (Position{0, 0, 2}));
    // an L of area 3 on a slope z = x
    EXPECT_EQ(polygon_normal(std::vector<Position>{
                  {0, 0, 0}, {2, 0, 2}, {2, 1, 2}, {1, 1, 1}, {1, 2, 1}, {0, 2, 0}}),
              (Position{-6, 0, 6}));
}

TEST(PolygonNormal, FarFromTheOriginItLosesNoDigits) {
    std::vector<Position> corners = kTriangle;
    for (Position& p : corners)
        p = {p[0] + 4.5e6, p[1] + 5.5e6, p[2] + 1e6};
    EXPECT_EQ(polygon_normal(corners), (Position{0, 0, 2}));
}

TEST(SixfoldVolume, IsPositiveWhereTheTriangleIsSeenCounterClockwiseFromOutside) {
    const Position o{1, 1, 1}, a{2, 1, 1}, b{1, 3, 1}, c{1, 1, 4};
    EXPECT_EQ(sixfold_volume(o, a, b, c), 6);
    EXPECT_EQ(sixfold_volume(o, b, a, c), -6);
    EXPECT_EQ(sixfold_volume(o, a, b, b), 0);
}

std::int8_t facing(const Nodes& one, const Nodes& other) {
    return facing_of(std::span(one), std::span(other));
}

TEST(FacingOf, LoopsOfTheSameNodesMayBeginAnywhere) {
    EXPECT_EQ(facing({1, 2, 3, 4}, {3, 4, 1, 2}), 1);
    EXPECT_EQ(facing({1, 2, 3, 4}, {2, 1, 4, 3}), -1);
    EXPECT_EQ(facing({1, 2, 3, 4}, {1, 3, 2, 4}), 0);
    EXPECT_EQ(facing({1, 2, 3}, {1, 2, 3, 4}), 0);
    EXPECT_EQ(facing({1, 2, 3, 2, 5}, {2, 5, 1, 2, 3}), 1);  // a node that is passed twice
    EXPECT_EQ(facing({1, 2, 3, 2, 5}, {2, 3, 2, 1, 5}), -1);
}

TEST(LoopHash, IsTheSameWhereverALoopBegins) {
    const Nodes one{1, 2, 3, 4}, same{3, 4, 1, 2}, other{1, 2, 3, 5};
    EXPECT_EQ(loop_hash(std::span(one)), loop_hash(std::span(same)));
    EXPECT_NE(loop_hash(std::span(one)), loop_hash(std::span(other)));
}

TEST(LoopTable, HasLoopsOfRegions) {
    LoopTable<std::int32_t> table;
    table.add_loop(Nodes{1, 2, 3});
    table.add_loop(Nodes{7, 8});
    table.end_region();
    table.nodes.push_back(4);
    table.end_loop();
    table.end_region();
    ASSERT_EQ(table.size(), 2U);
    ASSERT_EQ(table[0].size(), 2U);
    EXPECT_EQ(table[0][1][1], 8);
    std::size_t nodes = 0;
    for (const auto loop : table[0])
        nodes += loop.size();
    EXPECT_EQ(nodes, 5U);
    EXPECT_EQ(table[1][0][0], 4);
}

using NodeLoops = std::vector<std::vector<NodeId>>;

NodeLoops outlines(JoinedPolygons& joined) {
    NodeLoops found;
    joined.for_each_outline([&](std::span<const JoinedPolygons::PolygonHalfEdge> outline) {
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
    square.for_each_pair([&](std::int32_t p, std::int32_t q) {
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
    fan.separate([](std::int32_t p, std::int32_t q) { return p < 2 && q < 2; });
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
