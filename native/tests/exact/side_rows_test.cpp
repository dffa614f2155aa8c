// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/side_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "three_lines.hpp"

namespace realmodel::exact {
namespace {

int sign(const Sides& sides, std::size_t i) {
    return static_cast<int>(sides.left() >> i & 1U) - static_cast<int>(sides.right() >> i & 1U);
}

/// Twelve points on, above and below the diagonal from the origin, some of them by a unit in the
/// last place.
class BesideADiagonal : public testing::Test {
protected:
    BesideADiagonal() {
        for (const double x : {0.1, 0.3, 0.7, 1.3}) {
            for (const double y : {x, std::nextafter(x, 9), std::nextafter(x, -9)})
                points.push_back(g.add_vertex(x, y));
        }
        origin = g.add_vertex(0, 0);
        far = g.add_vertex(3, 3);
        south = g.add_vertex(1, -1);
        north = g.add_vertex(1, 2);
        low = g.add_plane({g.add_space_vertex(origin, 0), g.add_space_vertex(south, 1),
                           g.add_space_vertex(north, 1)});
        high = g.add_plane({g.add_space_vertex(origin, 1), g.add_space_vertex(south, 0.5),
                            g.add_space_vertex(north, 1)});
        g.freeze_vertices();
        diagonal = {g.add_edge(origin, far), origin, far};
        upright = {g.add_edge(south, north), south, north};
    }
    PointRow row(std::size_t size) const {
        PointRow row;
        for (std::size_t i = 0; i < size; ++i)
            row.add(scope, points[i]);
        return row;
    }
    PlanArrangement g;
    std::vector<PointId> points;
    VertexId origin, far, south, north;
    PlaneId low, high;
    DirectedEdge diagonal, upright;
    LocalArrangement scope{g};
};

TEST_F(BesideADiagonal, OnItNeitherBitIsSetAndBesideItOne) {
    const Sides sides = sides_of(scope, diagonal, row(12));
    EXPECT_EQ(sides.left(), 0b010'010'010'010U);
    EXPECT_EQ(sides.right(), 0b100'100'100'100U);
    EXPECT_EQ(sides.turned().left(), sides.right());
    EXPECT_EQ(sides.turned().right(), sides.left());
}

TEST_F(BesideADiagonal, BitsBeyondARowAreNotSet) {
    for (const std::size_t size : {1U, 2U, 3U, 11U}) {
        const Sides all = sides_of(scope, upright, row(12)),
                    some = sides_of(scope, upright, row(size));
        EXPECT_EQ(all.either(), all_of_row(12));
        EXPECT_EQ(some.left(), all.left() & all_of_row(size));
        EXPECT_EQ(some.right(), all.right() & all_of_row(size));
    }
}

TEST_F(BesideADiagonal, ARowOfPointsHasTheSidesOfEach) {
    const DirectedLine trace = scope.trace(low, high);
    const PointId crossing = scope.crossing(diagonal.line.id(), upright.line.id());
    PointRow points_of_all_kinds = row(11);
    points_of_all_kinds.add(scope, crossing);
    for (const DirectedLine line : {diagonal.line, upright.line, trace, trace.reversed()}) {
        const Sides sides = sides_of(scope, {line, crossing, crossing}, points_of_all_kinds);
        for (std::size_t i = 0; i < 12; ++i)
            EXPECT_EQ(sign(sides, i), scope.side(line, points_of_all_kinds.point[i]));
    }
}

TEST_F(BesideADiagonal, ARowOfLinesHasTheSidesOfEach) {
    const DirectedLine trace = scope.trace(low, high);
    LineRow lines;
    const PointId crossing = scope.crossing(diagonal.line.id(), upright.line.id());
    for (const DirectedEdge& edge : {diagonal, DirectedEdge{diagonal.line.reversed(), far, origin},
                                     upright, DirectedEdge{trace, crossing, crossing},
                                     DirectedEdge{trace.reversed(), crossing, crossing}})
        lines.add(scope, edge);
    points.push_back(crossing);
    for (const PointId point : points) {
        const Sides sides = sides_of(scope, lines, point);
        for (std::size_t i = 0; i < lines.size; ++i)
            EXPECT_EQ(sign(sides, i), scope.side(lines.line[i], point));
        EXPECT_EQ(sides.either() & ~all_of_row(5), 0U);
    }
}

TEST(SideRows, APointOnALineThoughItsDoublesAreNotIsOnNoSide) {
    const ThreeLinesThroughAThird lines;
    LocalArrangement scope(lines.g);
    const PointId at = scope.crossing(lines.one.id(), lines.two.id());
    PointRow points;
    points.add(scope, lines.a);
    points.add(scope, at);
    points.add(scope, lines.b);
    // between vertices, and between others
    for (const DirectedEdge& edge :
         {DirectedEdge{lines.three, lines.e, lines.f}, DirectedEdge{lines.three, at, at}}) {
        const Sides sides = sides_of(scope, edge, points);
        EXPECT_EQ(sides.left(), 0b001U);
        EXPECT_EQ(sides.right(), 0b100U);
        LineRow row;
        row.add(scope, edge);
        EXPECT_EQ(sides_of(scope, row, at).either(), 0U);
    }
}

TEST_F(BesideADiagonal, BeyondTheReachOfTheVerticesSidesAreExactToo) {
    // two edges whose lines cross beyond all vertices, at (30, 30)
    PlanArrangement other;
    const VertexId a = other.add_vertex(0, 0), b = other.add_vertex(1, 1),
                   c = other.add_vertex(0, 3), d = other.add_vertex(1, 3.9);
    other.freeze_vertices();
    const DirectedEdge ab{other.add_edge(a, b), a, b}, cd{other.add_edge(c, d), c, d};
    LocalArrangement beyond(other);
    const PointId at = beyond.crossing(ab.line.id(), cd.line.id());
    PointRow points_beyond;
    points_beyond.add(beyond, at);
    EXPECT_FALSE(points_beyond.within);
    EXPECT_EQ(sides_of(beyond, ab, points_beyond).either(), 0U);
    LineRow lines;
    lines.add(beyond, ab);
    lines.add(beyond, cd);
    lines.add(beyond, {other.add_edge(a, d), a, d});
    const Sides sides = sides_of(beyond, lines, at);
    EXPECT_EQ(sign(sides, 0), 0);
    EXPECT_EQ(sign(sides, 1), 0);
    EXPECT_EQ(sign(sides, 2), -1);
}

}  // namespace
}  // namespace realmodel::exact
