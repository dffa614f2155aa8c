// SPDX-License-Identifier: GPL-3.0-or-later
// Crossings and heights halfway between two doubles, and beside that by so little that the number
// types tell it one after another.
#include "exact/rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "exact/arithmetic.hpp"
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
        return scope.rounded_height(plane, scope.crossing(edge, across));
    }
    PlanArrangement g;
    PlaneId plane;
    LineId edge, across;
};

TEST(Rounding, AHeightWhereEdgesCross) {
    EXPECT_EQ(AnEdgeCrossedInItsMiddle(3, 4).height(), 3.5);
    EXPECT_EQ(AnEdgeCrossedInItsMiddle(1, 1 + kUlp).height(), 1);
    EXPECT_EQ(AnEdgeCrossedInItsMiddle(1 + kUlp, 1 + 2 * kUlp).height(), 1 + 2 * kUlp);
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

double nearest(const mpq_class& value) {
    return nearest_double(value.get_num(), value.get_den(), 0);
}

TEST(ExtendedInterval, RoundsOnlyWhatIsCertain) {
    const double one = 1.0, ulp = 0x1p-52;
    if (!nearest_sum(one, {0.0L, 0.0})) GTEST_SKIP() << "long double has no 64 bits here";
    EXPECT_EQ(nearest_sum(one, {0.0L, 0.0}), one);
    EXPECT_EQ(nearest_sum(one, {0.25L * ulp, 0.2 * ulp}), one);
    EXPECT_EQ(nearest_sum(one, {0.75L * ulp, 0.2 * ulp}), one + ulp);
    EXPECT_FALSE(nearest_sum(one, {0.5L * ulp, 0x1p-80}));
    EXPECT_FALSE(nearest_sum(0.0, {0.0L, 0x1p-80}));
    EXPECT_FALSE(nearest_sum(one, {0.0L, HUGE_VAL}));
    EXPECT_FALSE(nearest_sum(one, {0.0L, NAN}));
    EXPECT_FALSE(std::signbit(*nearest_sum(0.0, {-0.0L, 0.0})));
}

/// Heights of random planes at crossings of random edges, in places of different kinds.
TEST(ExtendedInterval, HeightsAreThoseOfRationalsAndNearlyAlwaysKnown) {
    std::mt19937_64 random(3);
    const auto uniform = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
    for (const double origin : {0.0, 5.3e6}) {
        int asked = 0, known = 0;
        for (int round = 0; round < 300; ++round) {
            PlanArrangement g;
            std::array<std::array<double, 3>, 7> p;
            std::array<SpaceId, 7> s;
            for (std::size_t i = 0; i < 7; ++i) {
                p[i] = {origin + uniform(), origin + uniform(), 10 * uniform()};
                s[i] = g.add_space_vertex(g.add_vertex(p[i][0], p[i][1]), p[i][2]);
            }
            const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
                return (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) -
                       (p[b][1] - p[a][1]) * (p[c][0] - p[a][0]);
            };
            const double across = (p[4][0] - p[3][0]) * (p[6][1] - p[5][1]) -
                                  (p[4][1] - p[3][1]) * (p[6][0] - p[5][0]);
            if (std::abs(turn(0, 1, 2)) < 0.01 || std::abs(across) < 0.01) continue;
            g.freeze_vertices();
            const PlaneId plane = turn(0, 1, 2) > 0 ? g.add_plane({s[0], s[1], s[2]})
                                                    : g.add_plane({s[0], s[2], s[1]});
            const auto line = [&](int from, int to) {
                return g.add_edge(VertexId(from), VertexId(to)).id();
            };
            const LineId l = line(3, 4), m = line(5, 6);
            LocalArrangement scope(g);
            const PointId point = scope.crossing(l, m);

            std::array<std::array<mpq_class, 3>, 7> e;
            for (std::size_t i = 0; i < 7; ++i)
                e[i] = {mpq_class(p[i][0]), mpq_class(p[i][1]), mpq_class(p[i][2])};
            const mpq_class ux = e[4][0] - e[3][0], uy = e[4][1] - e[3][1];
            const mpq_class vx = e[6][0] - e[5][0], vy = e[6][1] - e[5][1];
            const mpq_class wx = e[5][0] - e[3][0], wy = e[5][1] - e[3][1];
            const mpq_class share = (wx * vy - wy * vx) / (ux * vy - uy * vx);
            const mpq_class x = e[3][0] + share * ux, y = e[3][1] + share * uy;
            EXPECT_EQ(scope.rounded(point), (std::array{nearest(x), nearest(y)}));

            const mpq_class ax = e[1][0] - e[0][0], ay = e[1][1] - e[0][1];
            const mpq_class bx = e[2][0] - e[0][0], by = e[2][1] - e[0][1];
            const mpq_class area = ax * by - ay * bx, dx = x - e[0][0], dy = y - e[0][1];
            const mpq_class z = e[0][2] + (dx * by - dy * bx) / area * (e[1][2] - e[0][2]) +
                                (ax * dy - ay * dx) / area * (e[2][2] - e[0][2]);
            ++asked;
            if (const auto close = near_height(g, plane, scope.approximate(point))) {
                ++known;
                EXPECT_EQ(*close, nearest(z));
            }
            EXPECT_EQ(scope.rounded_height(plane, point), nearest(z));
        }
        EXPECT_GT(asked, 200);
        // elsewhere there may be no such numbers: then nothing is known, and that is right too
        if (nearest_sum(1.0, {0.0L, 0.0})) {
            EXPECT_GT(known, asked * 9 / 10);
        }
    }
}

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
