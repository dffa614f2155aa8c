// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "exact/local_arrangement.hpp"

namespace realmodel::exact {
namespace {

/// Two planes of one surface on both sides of the edge from (0, 0) to (4, 0), and two others over
/// or under them.
class FourPlanes : public testing::Test {
protected:
    FourPlanes() {
        north = g.add_plane({s, t, g.add_space_vertex(c, 0)});
        south = g.add_plane({t, s, g.add_space_vertex(d, 0)});
        level = g.add_plane(
            {g.add_space_vertex(e, 0.5), g.add_space_vertex(f, 0.5), g.add_space_vertex(c, 0.5)});
        steep = g.add_plane(
            {g.add_space_vertex(e, -4), g.add_space_vertex(f, 5), g.add_space_vertex(c, 2)});
        g.freeze_vertices();
        edge = g.add_edge(a, b).id();
        across = g.add_edge(d, c).id();
    }
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(4, 0), c = g.add_vertex(2, 3),
                   d = g.add_vertex(1, -3), e = g.add_vertex(-9, -9), f = g.add_vertex(9, -8);
    const SpaceId s = g.add_space_vertex(a, 0), t = g.add_space_vertex(b, 1);
    PlaneId north, south, level, steep;
    LineId edge, across;
};

TEST_F(FourPlanes, AboveACornerItIsTheSpaceVertexThere) {
    const LocalArrangement scope(g);
    EXPECT_EQ(scope.height_name(north, a), scope.height_name(south, a));
    EXPECT_EQ(scope.height_name(north, a), (HeightName{s, s}));
    EXPECT_EQ(scope.height_name(north, d), (HeightName(north)));
}

TEST_F(FourPlanes, OnAnEdgeItIsTheEdgeFromBothSides) {
    LocalArrangement scope(g);
    const PointId at = scope.crossing(edge, across);
    EXPECT_EQ(scope.height_name(north, at), (HeightName{s, t}));
    EXPECT_EQ(scope.height_name(south, at), (HeightName{s, t}));
    EXPECT_EQ(scope.height_name(level, at), (HeightName(level)));
}

TEST_F(FourPlanes, WhereAnEdgePiercesAPlaneThePlaneHasTheEdgesName) {
    LocalArrangement scope(g);
    const PointId at = scope.crossing(edge, scope.trace(south, level).id());
    EXPECT_EQ(scope.height_name(level, at), (HeightName{s, t}));
    EXPECT_EQ(scope.height_name(south, at), (HeightName{s, t}));
    EXPECT_EQ(scope.height_name(north, at), (HeightName{s, t}));
    EXPECT_EQ(scope.height_name(steep, at), (HeightName(steep)));
}

TEST_F(FourPlanes, OnATraceItIsTheFirstOfItsPlanes) {
    LocalArrangement scope(g);
    const PointId at = scope.crossing(across, scope.trace(steep, level).id());
    EXPECT_EQ(scope.height_name(level, at), (HeightName(level)));
    EXPECT_EQ(scope.height_name(steep, at), (HeightName(level)));
}

TEST_F(FourPlanes, WhereTracesMeetItIsThePlaneTheyHaveInCommon) {
    LocalArrangement scope(g);
    const PointId at =
        scope.crossing(scope.trace(north, steep).id(), scope.trace(steep, level).id());
    for (const PlaneId plane : {north, level, steep})
        EXPECT_EQ(scope.height_name(plane, at), (HeightName(steep)));
    EXPECT_EQ(scope.height_name(south, at), (HeightName(south)));
}

}  // namespace
}  // namespace realmodel::exact
