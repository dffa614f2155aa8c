// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/triangle_distances.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/floating_point.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {
namespace {

using Triangle = std::array<SpacePosition, 3>;

RationalPoint seen(const SpacePosition& q, const SpacePosition& p) {
    return minus(RationalPoint{mpq_class(q[0]), mpq_class(q[1]), mpq_class(q[2])},
                 RationalPoint{mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])});
}

RationalPoint normal_of(const RationalPoint& u, const RationalPoint& v) {
    return {cross(u, v, 0), cross(u, v, 1), cross(u, v, 2)};
}

/// The squared distance of a segment from the origin.
mpq_class square_to(const RationalPoint& a, const RationalPoint& b) {
    const RationalPoint along = minus(b, a);
    const mpq_class share = -dot(a, along) / dot(along, along);
    const RationalPoint at = interpolated(a, b,
                                          share < 0   ? mpq_class(0)
                                          : share > 1 ? mpq_class(1)
                                                      : share);
    return dot(at, at);
}

/// The same of a triangle: of its plane where the foot is within, else of an edge.
mpq_class square_to(const RationalPoint& a, const RationalPoint& b, const RationalPoint& c) {
    const RationalPoint normal = normal_of(minus(b, a), minus(c, a));
    const auto left_of = [&normal](const RationalPoint& from, const RationalPoint& to) {
        return sgn(dot(normal, normal_of(from, to)));
    };
    if (left_of(a, b) >= 0 && left_of(b, c) >= 0 && left_of(c, a) >= 0) {
        const mpq_class height = dot(normal, a);
        return height * height / dot(normal, normal);
    }
    return std::min({square_to(a, b), square_to(b, c), square_to(c, a)});
}

void expect_nearest(const SpacePosition& p, const std::vector<MarkedTriangle>& triangles) {
    std::vector<mpq_class> squares;
    for (const MarkedTriangle& t : triangles) {
        const auto& [a, b, c] = t.corners;
        squares.push_back(square_to(seen(a, p), seen(b, p), seen(c, p)));
        const auto [low, high] = distance_bounds(p, t.corners);
        EXPECT_LE(mpq_class(low) * mpq_class(low), squares.back());
        EXPECT_TRUE(high == HUGE_VAL || mpq_class(high) * mpq_class(high) >= squares.back());
    }
    const mpq_class least = *std::ranges::min_element(squares);
    std::vector<std::size_t> nearest;
    bool is_on_edge = false;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (squares[i] != least) continue;
        nearest.push_back(i);
        for (std::size_t k = 0; k < 3; ++k) {
            const SpacePosition &a = triangles[i].corners[k],
                                &b = triangles[i].corners[(k + 1) % 3];
            is_on_edge |=
                (triangles[i].edges >> k & 1U) != 0 && square_to(seen(a, p), seen(b, p)) == least;
        }
    }
    const NearestTriangles found = nearest_triangles(p, triangles);
    EXPECT_EQ(found.numbers, nearest);
    EXPECT_EQ(found.are_on_edge, is_on_edge);
    std::size_t farthest = 0;
    mpq_class most = -1;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto& [a, b, c] = triangles[i].corners;
        const RationalPoint o = seen(a, p), normal = normal_of(seen(b, a), seen(c, a));
        const mpq_class height = dot(normal, o), square = height * height / dot(normal, normal);
        if (square > most) farthest = i;
        most = std::max(most, square);
    }
    EXPECT_EQ(farthest_plane(p, triangles), farthest);
}

/// Some triangles with corners that `corner` gives, without those that have no area.
template <class Corner>
std::vector<MarkedTriangle> some(std::mt19937& random, const Corner& corner) {
    std::vector<MarkedTriangle> triangles;
    while (triangles.size() < 4) {
        const Triangle t{corner(), corner(), corner()};
        if (!in_one_line(t[0], t[1], t[2]))
            triangles.push_back({t, static_cast<unsigned>(random() % 8)});
    }
    return triangles;
}

TEST(TriangleDistances, OfALatticeAreThoseOfRationalNumbers) {
    std::mt19937 random(3);  // NOLINT(cert-msc32-c,cert-msc51-cpp)
    const auto corner = [&random] {
        SpacePosition p;
        for (double& x : p)
            x = static_cast<double>(random() % 4);
        return p;
    };
    for (int i = 0; i < 1000; ++i)
        expect_nearest(corner(), some(random, corner));
}

TEST(TriangleDistances, BesideNeedlesAndWithinAUnitAreThoseOfRationalNumbers) {
    std::mt19937 random(5);  // NOLINT(cert-msc32-c,cert-msc51-cpp)
    for (const double far : {0.0, 1.0, 4e6}) {
        const auto corner = [&] {
            SpacePosition p;
            for (double& x : p)
                x = moved_by_ulps(far + static_cast<double>(random() % 3),
                                  static_cast<int>(random() % 3) - 1);
            return p;
        };
        for (int i = 0; i < 250; ++i)
            expect_nearest(corner(), some(random, corner));
    }
}

TEST(TriangleDistances, OfAnySize) {
    const Triangle t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    for (const double size : {1e-200, 1e-100, 1e-30, 1e30, 1e100, 1e200}) {
        Triangle scaled = t, higher = t;
        for (auto* const one : {&scaled, &higher}) {
            for (auto& corner : *one) {
                for (double& x : corner)
                    x *= size;
            }
        }
        for (auto& corner : higher)
            corner[2] = std::nextafter(size, HUGE_VAL);
        expect_nearest({0.25 * size, 0.25 * size, 0.5 * size}, {{higher, 0}, {scaled, 0}});
        expect_nearest({-size, 0.25 * size, 2 * size}, {{higher, 4}, {scaled, 7}});
    }
}

/// The ratio in which a triangle's plane divides a line.
mpq_class crossing(const SpacePosition& from, const SpacePosition& to, const Triangle& triangle) {
    const auto rational = [](const SpacePosition& p) {
        return RationalPoint{mpq_class(p[0]), mpq_class(p[1]), mpq_class(p[2])};
    };
    const RationalPoint a = rational(triangle[0]), u = minus(rational(triangle[1]), a),
                        v = minus(rational(triangle[2]), a);
    const RationalPoint normal = cross(u, v);
    const mpq_class first = dot(normal, minus(rational(from), a)),
                    second = dot(normal, minus(rational(to), a));
    return first / (first - second);
}

TEST(CompareCrossings, IsTheOrderOfRationalRatios) {
    std::mt19937 random(1);  // NOLINT(cert-msc32-c,cert-msc51-cpp)
    const auto coordinate = [&random](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 0x1p32;
    };
    int ties = 0;
    for (int i = 0; i < 3000; ++i) {
        const SpacePosition from{coordinate(-1, 1), coordinate(-1, 1), coordinate(-3, -2)};
        const SpacePosition to{coordinate(-1, 1), coordinate(-1, 1), coordinate(2, 3)};
        std::array<Triangle, 2> two;
        for (auto& corner : two[0])
            corner = {coordinate(-1, 1), coordinate(-1, 1), coordinate(-0.1, 0.1)};
        two[1] = two[0];
        std::rotate(two[1].begin(), two[1].begin() + i % 3, two[1].end());
        if (i % 4 != 0) two[1][0][2] = moved_by_ulps(two[1][0][2], i % 4 - 2);
        if (i % 7 == 0) std::swap(two[1][0], two[1][1]);
        const mpq_class p = crossing(from, to, two[0]), q = crossing(from, to, two[1]);
        ties += p == q ? 1 : 0;
        EXPECT_EQ(compare_crossings(from, to, two[0], two[1]), sgn(mpq_class(p - q)));
        EXPECT_EQ(compare_crossings(from, to, two[1], two[0]), sgn(mpq_class(q - p)));
        EXPECT_EQ(compare_crossings(to, from, two[0], two[1]), sgn(mpq_class(q - p)));
    }
    EXPECT_GT(ties, 700);
}

TEST(CompareCrossings, APlaneThroughAnEndComesFirstThere) {
    const Triangle level{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
        higher{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
    EXPECT_EQ(compare_crossings({0.25, 0.25, 0}, {0, 0, 9}, level, higher), -1);
    EXPECT_EQ(compare_crossings({0.25, 0.25, 9}, {0, 0, 0}, level, higher), 1);
    EXPECT_EQ(compare_crossings({0.25, 0.25, 0}, {0, 0, 9}, level, level), 0);
}

}  // namespace
}  // namespace realmodel::exact
