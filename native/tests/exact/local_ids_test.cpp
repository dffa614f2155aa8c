// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_ids.hpp"

#include <gtest/gtest.h>

#include "exact/local_arrangement.hpp"

namespace realmodel::exact {
namespace {

/// A plan edge, and a plane over it that crosses two others.
class ThreePlanes : public testing::Test {
protected:
    PlaneId plane(double at_a, double at_b, double at_c) {
        return g.add_plane({g.add_space_vertex(a, at_a), g.add_space_vertex(b, at_b),
                            g.add_space_vertex(c, at_c)});
    }
    ThreePlanes() {
        level = plane(1, 1, 1);
        east = plane(0, 4, 0);
        north = plane(0, 0, 4);
        g.freeze_vertices();
        edge = g.add_edge(b, c).id();
    }
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(4, 0), c = g.add_vertex(0, 4);
    PlaneId level, east, north;
    LineId edge;
};

TEST_F(ThreePlanes, WhatIsFoundStaysLocalUntilItIsCommitted) {
    LocalArrangement scope(g);
    const LineId trace = scope.trace(east, level).id();
    const PointId at = scope.crossing(trace, edge);
    EXPECT_FALSE(scope.line(trace).is_edge());
    EXPECT_EQ(scope.point(at).x, 1);
    EXPECT_EQ(scope.point(at).y, 3);
    EXPECT_EQ(g.line_count(), 1U);
    EXPECT_EQ(g.point_count(), 3U);
}

TEST_F(ThreePlanes, ATraceHasOneNameWhicheverPlaneComesFirst) {
    LocalArrangement scope(g);
    const DirectedLine up = scope.trace(east, level), down = scope.trace(level, east);
    EXPECT_EQ(up.id(), down.id());
    EXPECT_NE(up.is_reversed(), down.is_reversed());
    const LineId other = scope.trace(north, east).id();
    EXPECT_NE(other, up.id());
    EXPECT_EQ(scope.line(other).planes()[0], east);
    EXPECT_EQ(scope.line(other).planes()[1], north);
}

TEST_F(ThreePlanes, AMarkedPointTakesItsLinesAlongAndTheRestStaysBehind) {
    LocalArrangement scope(g);
    const LineId unused = scope.trace(east, north).id(), x1 = scope.trace(east, level).id(),
                 y1 = scope.trace(north, level).id();
    scope.crossing(unused, edge);
    const PointId at = scope.crossing(x1, y1);
    scope.mark_point_used(at);
    scope.commit(g);
    EXPECT_EQ(g.line_count(), 3U);
    EXPECT_EQ(g.point_count(), 4U);
    const Point& own = g.point(scope.shared_point(at));
    EXPECT_EQ(own.x, 1);
    EXPECT_EQ(own.y, 1);
    EXPECT_EQ(own.first, scope.shared_line(x1));
    EXPECT_EQ(own.second, scope.shared_line(y1));
    EXPECT_EQ(g.line(own.first).planes()[1], east);
    EXPECT_EQ(g.line(own.second).planes()[1], north);
    EXPECT_EQ(g.line_count(), 3U);
}

TEST_F(ThreePlanes, ACommittedPointIsTheSameForOthers) {
    PointId shared;
    {
        LocalArrangement scope(g);
        const PointId at = scope.crossing(scope.trace(east, level).id(), edge);
        scope.mark_point_used(at);
        scope.commit(g);
        shared = scope.shared_point(at);
    }
    LocalArrangement other(g);
    EXPECT_EQ(other.side(other.trace(east, level), shared), 0);
    EXPECT_EQ(other.side(other.trace(north, level), shared), 1);
    EXPECT_TRUE(other.same_place(other.crossing(edge, other.trace(level, east).id()), shared));
}

TEST_F(ThreePlanes, DirectionsSurviveTheCommit) {
    LocalArrangement scope(g);
    const DirectedLine up = scope.trace(east, level), down = scope.trace(level, east);
    scope.mark_line_used(up.id());
    scope.commit(g);
    const DirectedLine shared_up = scope.shared_directed(up);
    EXPECT_EQ(scope.shared_directed(down), shared_up.reversed());
    EXPECT_EQ(shared_up.is_reversed(), up.is_reversed());
    LocalArrangement other(g);
    EXPECT_EQ(other.side(shared_up, b), 1);  // where it is higher
}

TEST_F(ThreePlanes, WhatWasNotMarkedIsAddedUnderItsNameOnce) {
    LocalArrangement first(g), second(g);
    const LineId one = first.trace(east, level).id(), same = second.trace(level, east).id();
    first.commit(g);
    second.commit(g);
    EXPECT_EQ(g.line_count(), 1U);
    EXPECT_EQ(first.shared_line(one), second.shared_line(same));
    EXPECT_EQ(g.line_count(), 2U);
}

}  // namespace
}  // namespace realmodel::exact
