// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/local_arrangement.hpp"

#include <gtest/gtest.h>

#include "three_lines.hpp"

namespace realmodel::exact {
namespace {

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
