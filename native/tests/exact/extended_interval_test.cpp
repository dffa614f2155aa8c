// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/extended_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "exact/arithmetic.hpp"

namespace realmodel::exact {
namespace {

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
        int asked = 0, known = 0, known_on_edge = 0, known_by_share = 0;
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
            if (const auto close = near_height(g, plane, scope.near(point))) {
                ++known;
                EXPECT_EQ(*close, nearest(z));
            }
            EXPECT_EQ(scope.rounded_height(plane, point), nearest(z));

            const mpq_class on_edge = e[3][2] + share * (e[4][2] - e[3][2]);
            if (const auto close = near_edge_height(g, s[3], s[4], scope.near(point))) {
                ++known_on_edge;
                EXPECT_EQ(*close, nearest(on_edge));
            }
            // the edge may be either of the two, and its lower vertex either of its ends
            const mpq_class of_other = (wx * uy - wy * ux) / (ux * vy - uy * vx);
            const mpq_class on_other = e[5][2] + of_other * (e[6][2] - e[5][2]);
            const std::array<std::pair<HeightName, mpq_class>, 3> names{
                {{{s[3], s[4]}, on_edge}, {{s[4], s[3]}, on_edge}, {{s[5], s[6]}, on_other}}};
            for (const auto& [name, height] : names) {
                if (const auto close = scope.rounded_height_of_crossing(name, point)) {
                    ++known_by_share;
                    EXPECT_EQ(*close, nearest(height));
                }
            }
            EXPECT_FALSE(scope.rounded_height_of_crossing({s[3], s[5]}, point));
            EXPECT_FALSE(scope.rounded_height_of_crossing(HeightName(plane), point));
        }
        EXPECT_GT(asked, 200);
        // elsewhere there may be no such numbers: then nothing is known, and that is right too
        if (nearest_sum(1.0, {0.0L, 0.0})) {
            EXPECT_GT(known, asked * 9 / 10);
            EXPECT_GT(known_on_edge, asked * 9 / 10);
            EXPECT_GT(known_by_share, 3 * asked * 9 / 10);
        }
    }
}

}  // namespace
}  // namespace realmodel::exact
