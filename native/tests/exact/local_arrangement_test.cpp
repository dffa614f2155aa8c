// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_arrangement.hpp"

#include <gtest/gtest.h>

#include "three_lines.hpp"

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

/// A square of 4 x 4 with its diagonals, a level plane, one that rises along x, and one along y.
class ASquare : public testing::Test {
protected:
    PlaneId plane(double at_a, double at_b, double at_d) {
        return g.add_plane({g.add_space_vertex(a, at_a), g.add_space_vertex(b, at_b),
                            g.add_space_vertex(d, at_d)});
    }
    ASquare() {
        level = plane(1, 1, 1);
        east = plane(0, 4, 0);
        north = plane(0, 0, 4);
        g.freeze_vertices();
        ac = g.add_edge(a, c);
        bd = g.add_edge(b, d);
        ab = g.add_edge(a, b);
        am = g.add_edge(a, middle);
    }
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(4, 0), c = g.add_vertex(4, 4),
                   d = g.add_vertex(0, 4), middle = g.add_vertex(2, 2);
    PlaneId level, east, north;
    DirectedLine ac, bd, ab, am;
};

TEST_F(ASquare, SidesAreSeenAlongTheLine) {
    LocalArrangement scope(g);
    EXPECT_EQ(scope.side(ac, d), 1);
    EXPECT_EQ(scope.side(ac, b), -1);
    EXPECT_EQ(scope.side(ac.reversed(), b), 1);
    EXPECT_EQ(scope.side(ac, middle), 0);
}

TEST_F(ASquare, ATraceIsPositiveWhereTheUpperPlaneIsHigher) {
    LocalArrangement scope(g);
    const DirectedLine trace = scope.trace(east, level);  // x = 1
    EXPECT_EQ(scope.side(trace, b), 1);
    EXPECT_EQ(scope.side(trace, a), -1);
    EXPECT_EQ(scope.trace(level, east), trace.reversed());
    EXPECT_EQ(scope.compare_heights(east, level, c), 1);
    EXPECT_EQ(scope.compare_heights(level, east, c), -1);
    EXPECT_EQ(scope.compare_heights(east, north, middle), 0);
}

TEST_F(ASquare, CrossingsAtAVertexAreThatVertex) {
    LocalArrangement scope(g);
    EXPECT_EQ(scope.crossing(ab.id(), ac.id()), PointId{a});
    // an end of one on the other
    EXPECT_EQ(scope.crossing(bd.id(), am.id()), PointId{middle});
    EXPECT_EQ(scope.crossing(am.id(), bd.id()), PointId{middle});
    // the diagonals cross in the vertex in the middle, which is an end of neither
    const PointId at = scope.crossing(ac.id(), bd.id());
    EXPECT_TRUE(scope.same_place(at, middle));
    EXPECT_TRUE(scope.same_place(middle, at));
    EXPECT_FALSE(scope.same_place(at, a));
}

TEST_F(ASquare, APlaceHasOneNameByTheSameLinesAndIsTheSameByOthers) {
    LocalArrangement scope(g);
    const LineId x1 = scope.trace(east, level).id(), y1 = scope.trace(north, level).id();
    const PointId at = scope.crossing(x1, y1);
    EXPECT_EQ(scope.crossing(y1, x1), at);
    EXPECT_EQ(scope.rounded(at), (std::array{1.0, 1.0}));
    const PointId other = scope.crossing(x1, ac.id());
    EXPECT_TRUE(scope.same_place(at, other));
    EXPECT_EQ(scope.compare(0, at, other), 0);
}

TEST_F(ASquare, LinesAreTheSameWhereTheyRunThroughTheSamePlaces) {
    LocalArrangement scope(g);
    const LineId diagonal = scope.trace(east, north).id();  // x = y
    EXPECT_TRUE(scope.same_line(diagonal, ac.id()));
    EXPECT_TRUE(scope.same_line(ac.id(), diagonal));
    EXPECT_FALSE(scope.same_line(diagonal, bd.id()));
    EXPECT_EQ(scope.direction_signs(ac.id()), (std::array{1, 1}));
    EXPECT_EQ(scope.direction_signs(bd.id()), (std::array{-1, 1}));
    EXPECT_EQ(scope.direction_signs(diagonal), (std::array{-1, -1}));  // the higher one on its left
}

TEST_F(ASquare, CompareIsTheWayFromTheFirstToTheSecond) {
    LocalArrangement scope(g);
    const PointId at = scope.crossing(scope.trace(east, level).id(), bd.id());  // (1, 3)
    EXPECT_EQ(scope.compare(0, a, at), 1);
    EXPECT_EQ(scope.compare(1, at, middle), -1);
    EXPECT_EQ(scope.compare(1, at, at), 0);
}

TEST(LocalArrangement, ACrossingLiesOnAThirdLineThoughItsDoublesDoNot) {
    const ThreeLinesThroughAThird lines;
    LocalArrangement scope(lines.g);
    const PointId at = scope.crossing(lines.one.id(), lines.two.id());
    EXPECT_EQ(scope.side(lines.three, at), 0);
    EXPECT_GT(scope.exact_decisions(), 0U);
    EXPECT_TRUE(scope.same_place(at, scope.crossing(lines.two.id(), lines.three.id())));
}

}  // namespace
}  // namespace realmodel::exact
