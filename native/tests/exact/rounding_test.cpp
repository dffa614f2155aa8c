// SPDX-License-Identifier: GPL-3.0-or-later
// Crossings and heights halfway between two doubles, and beside that by so little that the number
// types tell it one after another.
#include <gtest/gtest.h>

#include "exact/extended_interval.hpp"
#include "exact/local_arrangement.hpp"

namespace realmodel::exact {
namespace {

constexpr double kUlp = 0x1p-52;  // of 1
constexpr double kBeside[] = {0x1p-8, 0x1p-20, 0x1p-35, 0x1p-50};

/// Where the axis of x is crossed on the way from `from` below it to `to` above it; 1 both
/// distances, the latter off by `more`: beyond half way where it is less.
double crossing_of_axis(double from, double to, double more) {
    PlanArrangement g;
    const VertexId west = g.add_vertex(-4, 0), east = g.add_vertex(8, 0),
                   south = g.add_vertex(from, -1), north = g.add_vertex(to, 1 + more);
    g.freeze_vertices();
    const LineId axis = g.add_edge(west, east).id(), across = g.add_edge(south, north).id();
    LocalArrangement scope(g);
    const auto at = scope.rounded(scope.crossing(axis, across));
    EXPECT_EQ(at[1], 0);
    EXPECT_EQ(scope.rounded(scope.crossing(across, axis)), at);
    return at[0];
}

TEST(Rounding, ACrossingHalfwayGoesToTheEvenDouble) {
    EXPECT_EQ(crossing_of_axis(1, 1 + kUlp, 0), 1);
    EXPECT_EQ(crossing_of_axis(1 + kUlp, 1 + 2 * kUlp, 0), 1 + 2 * kUlp);
    EXPECT_EQ(crossing_of_axis(-1, -1 - kUlp, 0), -1);
    EXPECT_EQ(crossing_of_axis(-1 - kUlp, -1 - 2 * kUlp, 0), -1 - 2 * kUlp);
}

TEST(Rounding, ACrossingBesideHalfwayGoesToTheNearerDouble) {
    for (const double little : kBeside) {
        EXPECT_EQ(crossing_of_axis(1, 1 + kUlp, little), 1);
        EXPECT_EQ(crossing_of_axis(1, 1 + kUlp, -little), 1 + kUlp);
        EXPECT_EQ(crossing_of_axis(1 + kUlp, 1 + 2 * kUlp, little), 1 + kUlp);
        EXPECT_EQ(crossing_of_axis(1 + kUlp, 1 + 2 * kUlp, -little), 1 + 2 * kUlp);
    }
}

/// A plane that rises along x from one height at 0 to another at 2, above a vertex at 1 + `beyond`,
/// which is none of its corners.
double height_in_the_middle(double from, double to, double beyond) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(2, 0), c = g.add_vertex(0, 3),
                   middle = g.add_vertex(1 + beyond, 0);
    const PlaneId plane = g.add_plane(
        {g.add_space_vertex(a, from), g.add_space_vertex(b, to), g.add_space_vertex(c, from)});
    g.freeze_vertices();
    LocalArrangement scope(g);
    EXPECT_EQ(scope.rounded_height(plane, a), from);  // a corner
    return scope.rounded_height(plane, middle);
}

TEST(Rounding, AHeightHalfwayGoesToTheEvenDouble) {
    EXPECT_EQ(height_in_the_middle(1, 1 + kUlp, 0), 1);
    EXPECT_EQ(height_in_the_middle(1 + kUlp, 1 + 2 * kUlp, 0), 1 + 2 * kUlp);
    EXPECT_EQ(height_in_the_middle(-1 - kUlp, -1 - 2 * kUlp, 0), -1 - 2 * kUlp);
}

TEST(Rounding, AHeightBesideHalfwayGoesToTheNearerDouble) {
    for (const double little : kBeside) {
        EXPECT_EQ(height_in_the_middle(1, 1 + kUlp, little), 1 + kUlp);
        EXPECT_EQ(height_in_the_middle(1 + kUlp, 1 + 2 * kUlp, -little), 1 + kUlp);
    }
}

/// Two edges that cross in the middle of both; a plane on the first of them, with these heights at
/// its ends.
class AnEdgeCrossedInItsMiddle {
public:
    AnEdgeCrossedInItsMiddle(double from, double to) {
        const VertexId a = g.add_vertex(0, 0), b = g.add_vertex(2, 0), c = g.add_vertex(0, 3);
        plane = g.add_plane(
            {g.add_space_vertex(a, from), g.add_space_vertex(b, to), g.add_space_vertex(c, 7)});
        const VertexId south = g.add_vertex(1, -1), north = g.add_vertex(1, 1);
        g.freeze_vertices();
        edge = g.add_edge(a, b).id();
        across = g.add_edge(south, north).id();
    }
    double height() const {
        LocalArrangement scope(g);
        const PointId at = scope.crossing(edge, across);
        const HeightName name = scope.height_name(plane, at);
        const double z = scope.rounded_height(plane, at);
        EXPECT_EQ(scope.rounded_height(plane, name, at, scope.near(at)), z);
        const auto quickly = scope.rounded_height_of_crossing(name, at);
        EXPECT_EQ(quickly.value_or(z), z);
        return z;
    }
    PlanArrangement g;
    PlaneId plane;
    LineId edge, across;
};

TEST(Rounding, AHeightOnAnEdgeIsTheSameEveryWay) {
    EXPECT_EQ(AnEdgeCrossedInItsMiddle(3, 4).height(), 3.5);
    EXPECT_EQ(AnEdgeCrossedInItsMiddle(1, 1 + kUlp).height(), 1);
    EXPECT_EQ(AnEdgeCrossedInItsMiddle(1 + kUlp, 1 + 2 * kUlp).height(), 1 + 2 * kUlp);
    const AnEdgeCrossedInItsMiddle sure(3, 4);
    LocalArrangement scope(sure.g);
    const PointId at = scope.crossing(sure.edge, sure.across);
    if (!nearest_sum(1, {0.0L, 0})) GTEST_SKIP() << "long double has no 64 bits here";
    EXPECT_EQ(scope.rounded_height_of_crossing(scope.height_name(sure.plane, at), at), 3.5);
}

/// The slope of the key of a line from (-less_x, -less_y) to (2, 1), as it is stored: downward.
double key_slope(double less_x, double less_y) {
    PlanArrangement g;
    const VertexId from = g.add_vertex(-less_x, -less_y), to = g.add_vertex(2, 1);
    g.freeze_vertices();
    const LineId line = g.add_edge(from, to).id();
    LocalArrangement scope(g);
    const auto key = scope.line_key(line);
    EXPECT_EQ(key[0], 0);
    EXPECT_EQ(key[2], 0);  // it passes the first vertex, which offsets are counted from
    return key[1];
}

TEST(Rounding, ASlopeHalfwayGoesToTheEvenDoubleAndBesideItToTheNearer) {
    EXPECT_EQ(key_slope(0, 0x1p-53), -0.5);
    EXPECT_EQ(key_slope(0, 3 * 0x1p-53), -0.5 * (1 + 2 * kUlp));
    for (const double little : {0x1p-60, 0x1p-90}) {
        EXPECT_EQ(key_slope(little, 3 * 0x1p-53), -0.5 * (1 + kUlp));
        EXPECT_EQ(key_slope(-little, 0x1p-53), -0.5 * (1 + kUlp));
    }
}

TEST(Rounding, LinesThroughTheSamePlacesHaveOneKey) {
    PlanArrangement g;
    const VertexId o = g.add_vertex(0, 0), a = g.add_vertex(0, 1), b = g.add_vertex(3, 2),
                   c = g.add_vertex(9, 4), d = g.add_vertex(9, 5);
    g.freeze_vertices();
    const LineId ab = g.add_edge(a, b).id(), bc = g.add_edge(b, c).id(), ad = g.add_edge(a, d).id(),
                 oa = g.add_edge(o, a).id();
    LocalArrangement scope(g);
    // x - 3 y + 3 = 0, by its larger coefficient
    EXPECT_EQ(scope.line_key(ab), (std::array{0.0, -1.0 / 3, -1.0}));
    EXPECT_EQ(scope.line_key(bc), scope.line_key(ab));
    EXPECT_NE(scope.line_key(ad), scope.line_key(ab));
    EXPECT_EQ(scope.line_key(oa)[0], 1);  // steep
}

}  // namespace
}  // namespace realmodel::exact
