// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "../validation/small_complex.hpp"
#include "cutting/plane_division.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {
namespace {

std::string refusal(const Plane& plane) {
    try {
        checked_plane(plane);
    } catch (const InputError& error) {
        return error.kind;
    }
    return "";
}

TEST(PlaneEdges, APlaneNeedsAPointAndADirection) {
    EXPECT_EQ(refusal({{0, 0, 1}, {0, 0, 1e-300}}), "");
    EXPECT_EQ(refusal({{0, 0, 1}, {0, 0, 0}}), "bad_plane");
    EXPECT_EQ(refusal({{0, 0, 1}, {0, NAN, 1}}), "not_finite");
    EXPECT_EQ(refusal({{HUGE_VAL, 0, 1}, {0, 0, 1}}), "not_finite");
}

TEST(PlaneEdges, VerticesLieOnThePlaneOrBesideItByAsLittleAsADouble) {
    auto cubes = validation::two_cubes();  // heights 0, 1 and 2
    const auto middle_side = [&](const Plane& plane) {
        const auto sides = vertex_sides(cubes.view(), checked_plane(plane), {1, nullptr});
        EXPECT_EQ(sides.size(), 12U);
        EXPECT_EQ(sides[0], -sides[11]);
        return sides[4];
    };
    EXPECT_EQ(middle_side({{7, 7, 1}, {0, 0, 1}}), kOn);
    EXPECT_EQ(middle_side({{7, 7, std::nextafter(1, 2)}, {0, 0, 1}}), kBelow);
    EXPECT_EQ(middle_side({{7, 7, std::nextafter(1, 0)}, {0, 0, 1}}), kAbove);
    EXPECT_EQ(middle_side({{7, 7, std::nextafter(1, 0)}, {0, 0, -1}}), kBelow);
}

class AThirdUp : public testing::Test {
protected:
    static std::array<NodeId, 2> edge(int a, int b) { return {NodeId{a}, NodeId{b}}; }
    validation::OwnedComplex cubes = validation::two_cubes();
    const ComplexView model = cubes.view();
    // x + 3 z = 1: a third up at x = 0
    EdgeIntersections cuts{
        model, checked_plane({{1, 0, 0}, {1, 0, 3}}), {edge(3, 7), edge(0, 4), edge(3, 7)}};
};

TEST_F(AThirdUp, EachEdgeIsCutOnceInTheNearestDoubles) {
    ASSERT_EQ(cuts.size(), 2U);
    EXPECT_EQ(cuts.positions(), (std::vector<Position>{{0, 0, 1.0 / 3}, {0, 1, 1.0 / 3}}));
}

TEST_F(AThirdUp, NodesFollowTheVerticesInTheOrderOfTheEdges) {
    EXPECT_EQ(cuts.first_node(), NodeId{12});
    EXPECT_EQ(cuts.node(NodeId{0}, NodeId{4}), NodeId{12});
    EXPECT_EQ(cuts.node(NodeId{7}, NodeId{3}), NodeId{13});
    EXPECT_EQ(cuts.edge(NodeId{13}), edge(3, 7));
    EXPECT_TRUE(cuts.contains(NodeId{12}));
    EXPECT_FALSE(cuts.contains(NodeId{11}));
}

}  // namespace
}  // namespace realmodel::cutting
