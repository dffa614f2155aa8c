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
    EXPECT_EQ(scope.side(opposite(ac), b), 1);
    EXPECT_EQ(scope.side(ac, middle), 0);
}

TEST_F(ASquare, ATraceIsPositiveWhereTheUpperPlaneIsHigher) {
    LocalArrangement scope(g);
    const DirectedLine trace = scope.trace(east, level);  // x = 1
    EXPECT_EQ(scope.side(trace, b), 1);
    EXPECT_EQ(scope.side(trace, a), -1);
    EXPECT_EQ(scope.trace(level, east), opposite(trace));
    EXPECT_EQ(scope.compare_heights(east, level, c), 1);
    EXPECT_EQ(scope.compare_heights(level, east, c), -1);
    EXPECT_EQ(scope.compare_heights(east, north, middle), 0);
}

TEST_F(ASquare, CrossingsAtAVertexAreThatVertex) {
    LocalArrangement scope(g);
    EXPECT_EQ(scope.crossing(line_of(ab), line_of(ac)), PointId{a});
    // an end of one on the other
    EXPECT_EQ(scope.crossing(line_of(bd), line_of(am)), PointId{middle});
    EXPECT_EQ(scope.crossing(line_of(am), line_of(bd)), PointId{middle});
    // the diagonals cross in the vertex in the middle, which is an end of neither
    const PointId at = scope.crossing(line_of(ac), line_of(bd));
    EXPECT_TRUE(scope.same_place(at, middle));
    EXPECT_TRUE(scope.same_place(middle, at));
    EXPECT_FALSE(scope.same_place(at, a));
}

TEST_F(ASquare, APlaceHasOneNameByTheSameLinesAndIsTheSameByOthers) {
    LocalArrangement scope(g);
    const LineId x1 = line_of(scope.trace(east, level)), y1 = line_of(scope.trace(north, level));
    const PointId at = scope.crossing(x1, y1);
    EXPECT_EQ(scope.crossing(y1, x1), at);
    EXPECT_EQ(scope.rounded(at), (std::array{1.0, 1.0}));
    const PointId other = scope.crossing(x1, line_of(ac));
    EXPECT_TRUE(scope.same_place(at, other));
    EXPECT_EQ(scope.compare(0, at, other), 0);
}

TEST_F(ASquare, LinesAreTheSameWhereTheyRunThroughTheSamePlaces) {
    LocalArrangement scope(g);
    const LineId diagonal = line_of(scope.trace(east, north));  // x = y
    EXPECT_TRUE(scope.same_line(diagonal, line_of(ac)));
    EXPECT_TRUE(scope.same_line(line_of(ac), diagonal));
    EXPECT_FALSE(scope.same_line(diagonal, line_of(bd)));
    EXPECT_EQ(scope.direction_signs(line_of(ac)), (std::array{1, 1}));
    EXPECT_EQ(scope.direction_signs(line_of(bd)), (std::array{-1, 1}));
    EXPECT_EQ(scope.direction_signs(diagonal), (std::array{-1, -1}));  // the higher one on its left
}

TEST_F(ASquare, CompareIsTheWayFromTheFirstToTheSecond) {
    LocalArrangement scope(g);
    const PointId at = scope.crossing(line_of(scope.trace(east, level)), line_of(bd));  // (1, 3)
    EXPECT_EQ(scope.compare(0, a, at), 1);
    EXPECT_EQ(scope.compare(1, at, middle), -1);
    EXPECT_EQ(scope.compare(1, at, at), 0);
}

TEST(LocalArrangement, ACrossingLiesOnAThirdLineThoughItsDoublesDoNot) {
    const ThreeLinesThroughAThird lines;
    LocalArrangement scope(lines.g);
    const PointId at = scope.crossing(line_of(lines.one), line_of(lines.two));
    EXPECT_EQ(scope.side(lines.three, at), 0);
    EXPECT_GT(scope.exact_decisions(), 0U);
    EXPECT_TRUE(scope.same_place(at, scope.crossing(line_of(lines.two), line_of(lines.three))));
}

}  // namespace
}  // namespace realmodel::exact
