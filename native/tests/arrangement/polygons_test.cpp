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

}  // namespace
}  // namespace realmodel::arrangement
