// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/reach_filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "three_lines.hpp"

namespace realmodel::exact {
namespace {

int side_by_filter(LocalArrangement& scope, const DirectedEdge& edge, PointId point) {
    return side_of(scope, reach_filter(scope, edge), edge.line, point,
                   position_in_reach(scope, point));
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
    PlanArrangement g;
    std::vector<PointId> points;
    VertexId origin, far, south, north;
    PlaneId low, high;
    DirectedEdge diagonal, upright;
    LocalArrangement scope{g};
};

TEST_F(BesideADiagonal, OnItAPointIsOnNoSide) {
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_EQ(side_by_filter(scope, diagonal, points[i]), (std::array{0, 1, -1})[i % 3]);
}

TEST_F(BesideADiagonal, EachPointHasItsSideOfLinesOfAllKinds) {
    const DirectedLine trace = scope.trace(low, high);
    const PointId crossing = scope.crossing(diagonal.line.id(), upright.line.id());
    points.push_back(crossing);
    for (const DirectedEdge& edge : {diagonal, DirectedEdge{diagonal.line.reversed(), far, origin},
                                     upright, DirectedEdge{trace, crossing, crossing},
                                     DirectedEdge{trace.reversed(), crossing, crossing}}) {
        for (const PointId point : points)
            EXPECT_EQ(side_by_filter(scope, edge, point), scope.side(edge.line, point));
    }
}

TEST(ReachFilter, APointOnALineThoughItsDoublesAreNotIsOnNoSide) {
    const ThreeLinesThroughAThird lines;
    LocalArrangement scope(lines.g);
    const PointId at = scope.crossing(lines.one.id(), lines.two.id());
    // between vertices, and between others
    for (const DirectedEdge& edge :
         {DirectedEdge{lines.three, lines.e, lines.f}, DirectedEdge{lines.three, at, at}}) {
        EXPECT_EQ(side_by_filter(scope, edge, lines.a), 1);
        EXPECT_EQ(side_by_filter(scope, edge, at), 0);
        EXPECT_EQ(side_by_filter(scope, edge, lines.b), -1);
    }
}

TEST(ReachFilter, BeyondTheReachOfTheVerticesSidesAreExactToo) {
    // two edges whose lines cross beyond all vertices, at (30, 30)
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(1, 1), c = g.add_vertex(0, 3),
                   d = g.add_vertex(1, 3.9);
    g.freeze_vertices();
    const DirectedEdge ab{g.add_edge(a, b), a, b}, cd{g.add_edge(c, d), c, d};
    LocalArrangement beyond(g);
    const PointId at = beyond.crossing(ab.line.id(), cd.line.id());
    EXPECT_FALSE(g.reach().has(beyond.point(at).x, beyond.point(at).y));
    EXPECT_EQ(side_by_filter(beyond, ab, at), 0);
    EXPECT_EQ(side_by_filter(beyond, cd, at), 0);
    EXPECT_EQ(side_by_filter(beyond, {g.add_edge(a, d), a, d}, at), -1);
}

}  // namespace
}  // namespace realmodel::exact
