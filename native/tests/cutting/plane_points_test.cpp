// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../validation/small_complex.hpp"
#include "cutting/plane_division.hpp"
#include "exact/orientation.hpp"

namespace realmodel::cutting {
namespace {

/// Far from the origin, edges from vertex 0 to heights of 3 are cut at height 1, a third of their
/// way: in nodes 4, 5 and 6. Rounding moves these by far more than differences of doubles are off.
struct Thirds {
    explicit Thirds(const Position& last, double upward = 1)
        : complex(shifted({{0, 0, 0}, {1, 8, 3}, {2, 15, 3}, last})),
          plane(checked_plane({{0, 0, 1}, {0, 0, upward}})) {}
    static validation::OwnedComplex shifted(const std::vector<Position>& positions) {
        validation::OwnedComplex complex;
        for (const auto& [x, y, z] : positions)
            complex.vertices.push_back({4e6 + x, 4e6 + y, z});
        return complex;
    }
    LoopCorner corner(int node) const {
        return {NodeId{node}, points.view()(points.rounded(NodeId{node}))};
    }
    int turn() const { return points(corner(4), corner(5), corner(6)); }

    validation::OwnedComplex complex;
    ComplexView model = complex.view();
    exact::OrientedPlane plane;
    std::vector<std::array<NodeId, 2>> edges{
        {NodeId{0}, NodeId{1}}, {NodeId{0}, NodeId{2}}, {NodeId{0}, NodeId{3}}};
    EdgeIntersections cuts{model, plane, edges};
    PlanePoints points{model, plane, cuts};
};

/// A little more or less than doubles can tell at a third of it.
constexpr double kLittle = 0x1p-30;

TEST(PlanePoints, LieOnOneLineThoughTheirDoublesDoNot) {
    const Thirds thirds({4, 29, 3});
    EXPECT_NE(exact::orient2d(thirds.corner(4).at, thirds.corner(5).at, thirds.corner(6).at), 0);
    EXPECT_EQ(thirds.turn(), 0);
}

TEST(PlanePoints, TurnWhereTheirEdgesSaySo) {
    EXPECT_EQ(Thirds({4, 29 + kLittle, 3}).turn(), 1);
    EXPECT_EQ(Thirds({4, 29 - kLittle, 3}).turn(), -1);
    EXPECT_EQ(Thirds({4, 29 + kLittle, 3}, -1).turn(), -1);  // seen from below
}

TEST(PlanePoints, OneNodeTwiceTurnsNowhere) {
    const Thirds thirds({4, 40, 3});
    EXPECT_EQ(thirds.points(thirds.corner(4), thirds.corner(5), thirds.corner(4)), 0);
}

TEST(PlanePoints, AreAboveOrBelowWhatThreeOfThemSpan) {
    const Thirds thirds({4, 40, 3});  // 4, 5, 6 turn left seen from above
    const auto side = [&](int node) {
        return thirds.points.tetrahedron(NodeId{4}, NodeId{5}, NodeId{6}, NodeId{node});
    };
    EXPECT_EQ(side(1), 1);
    EXPECT_EQ(side(0), -1);
}

TEST(PlanePoints, OfAPlaneThroughVerticesTheyKnowTheirSide) {
    const auto side = [](const Position& last) {
        return Thirds(last).points.tetrahedron(NodeId{0}, NodeId{1}, NodeId{2}, NodeId{6});
    };
    EXPECT_EQ(side({4, 29, 3}), 0);
    EXPECT_EQ(side({4, 29 + kLittle, 3}), 1);
    EXPECT_EQ(side({4, 29 - kLittle, 3}), -1);
}

}  // namespace
}  // namespace realmodel::cutting
