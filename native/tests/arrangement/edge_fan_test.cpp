// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/edge_fan.hpp"

#include <gtest/gtest.h>

namespace realmodel::arrangement {
namespace {

class AnEdgeUpward : public testing::Test {
protected:
    exact::SpacePointId at(double x, double y, double z) { return points.add(Position{x, y, z}); }
    HalfPlane towards(double x, double y) { return {at(x, y, 0.5), -1, 1}; }
    std::vector<std::vector<std::size_t>> half_planes(const std::vector<HalfPlane>& items) {
        EdgeFan fan;
        find_fan(points, a, b, items, fan);
        std::vector<std::vector<std::size_t>> found;
        for (std::size_t i = 0; i < fan.half_planes(); ++i)
            found.emplace_back(fan.half_plane(i).begin(), fan.half_plane(i).end());
        return found;
    }
    exact::SpacePoints points;
    exact::SpacePointId a = at(0, 0, 0), b = at(0, 0, 1);
};

using Blades = std::vector<std::vector<std::size_t>>;

TEST_F(AnEdgeUpward, HalfPlanesStandInOneDirectionFromTheFirst) {
    // whoever looks along the edge, upward, sees them turn clockwise from above
    EXPECT_EQ(half_planes({towards(1, 0), towards(0, 1), towards(-1, 0.1), towards(-1, -1)}),
              (Blades{{0}, {3}, {2}, {1}}));
    EXPECT_EQ(half_planes({towards(1, 0), towards(-1, -1), towards(-1, 0), towards(1, 1)}),
              (Blades{{0}, {1}, {2}, {3}}));
}

TEST_F(AnEdgeUpward, WhatLiesInOneDirectionMakesOneBlade) {
    EXPECT_EQ(half_planes({towards(1, 1), towards(-1, 0), towards(3, 3), towards(-2, 0)}),
              (Blades{{0, 2}, {1, 3}}));
    EXPECT_EQ(half_planes({towards(1, 1), towards(2, 2)}), (Blades{{0, 1}}));
}

TEST_F(AnEdgeUpward, ParallelToAnAxisItIsSeenAlongAnother) {
    EXPECT_EQ(half_planes({towards(0, 1), towards(0, -1), towards(0, 2)}), (Blades{{0, 2}, {1}}));
}

TEST_F(AnEdgeUpward, TwoOfOnePlaneNeedNoArithmetic) {
    HalfPlane one = towards(1, 0), same = towards(-5, 0), back = towards(1, 0);
    one.plane = same.plane = back.plane = 7;
    back.direction = -1;
    // what they are said to be counts, wherever they point
    EXPECT_EQ(half_planes({one, same, back}), (Blades{{0, 1}, {2}}));
}

TEST(EdgeUse, KnowsWhatIsAheadGoingRound) {
    std::vector<EdgeUse> uses;
    for_each_edge(std::vector<std::vector<NodeId>>{{1, 5, 3}}, 9,
                  [&](const EdgeUse& use) { uses.push_back(use); });
    ASSERT_EQ(uses.size(), 3U);
    EXPECT_EQ(uses[0].edge, (std::array<NodeId, 2>{1, 5}));
    EXPECT_EQ(uses[0].ahead(), 0U);
    EXPECT_EQ(uses[1].edge, (std::array<NodeId, 2>{3, 5}));
    EXPECT_EQ(uses[1].direction, -1);
    EXPECT_EQ(uses[1].ahead(), 1U);
    EXPECT_EQ(uses[2].behind(), 0U);
}

TEST(EdgesOf, EachEdgeHasAllItsUses) {
    const std::vector<std::array<NodeId, 3>> triangles{{0, 1, 2}, {2, 1, 3}, {1, 2, 4}};
    const EdgeUses edges =
        edges_of(3, 5, [&](std::size_t t) -> const auto& { return triangles[t]; }, {1, nullptr});
    ASSERT_EQ(edges.size(), 7U);
    std::vector<std::array<NodeId, 2>> ends;
    for (std::size_t e = 0; e < edges.size(); ++e)
        ends.push_back(edges.ends(e));
    EXPECT_EQ(ends, (std::vector<std::array<NodeId, 2>>{
                        {0, 1}, {0, 2}, {1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}}));
    ASSERT_EQ(edges[2].size(), 3U);
    EXPECT_EQ(edges[2][0].direction, 1);
    EXPECT_EQ(edges[2][1].direction, -1);
    EXPECT_EQ(edges[2][2].item, 2);
    EXPECT_EQ(edges.between({1, 2}).data(), edges[2].data());
    EXPECT_EQ(edges.between({1, 2}).size(), 3U);
    EXPECT_TRUE(edges.between({0, 3}).empty());
}

}  // namespace
}  // namespace realmodel::arrangement
