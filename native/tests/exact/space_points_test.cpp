// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/space_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace realmodel::exact {
namespace {

/// Points of many kinds, with intersections of lines and planes through them among them.
std::vector<SpacePointId> some_points(SpacePoints& points, std::mt19937_64& random, int kind) {
    const auto coordinate = [&]() -> double {
        const auto whole = static_cast<double>(random() % 5);
        if (kind == 0) return whole;                                        // a lattice
        if (kind == 1) return static_cast<double>(random() % 1000) / 1000;  // not on doubles
        if (kind == 2) return 5e5 + whole / 10;                             // far from the origin
        return std::ldexp(whole - 2, static_cast<int>(random() % 600) - 300);  // too wide a range
    };
    std::vector<SpacePointId> made;
    for (int i = 0; i < 8; ++i)
        made.push_back(points.add(SpacePosition{coordinate(), coordinate(), coordinate()}));
    for (int i = 0; i < 12; ++i) {
        const auto any = [&] { return made[random() % made.size()]; };
        const SpacePointId p = any(), q = any(), a = any(), b = any(), c = any();
        const int from = orient3d(points, a, b, c, p), to = orient3d(points, a, b, c, q);
        if (from * to < 0) made.push_back(points.intersection(p, q, a, b, c));
        if (i == 6) made.push_back(points.middle({p, q, a}));
        if (i % 4 == 3 && orient2d(points, 2, a, b, c) != 0)
            made.push_back(points.intersection(2, a, points.middle({a, b, c}), b, c));
    }
    return made;
}

int sign_of_determinant(const SpacePoints& points, SpacePointId a, SpacePointId b, SpacePointId c,
                        SpacePointId d) {
    const RationalPoint o = points.exact(a);
    return sgn(dot(minus(points.exact(b), o),
                   cross(minus(points.exact(c), o), minus(points.exact(d), o))));
}

TEST(SpacePoints, SignsAreThoseOfRationalPoint) {
    std::mt19937_64 random(7);
    for (int round = 0; round < 120; ++round) {
        SpacePoints points;
        const auto made = some_points(points, random, round % 4);
        const auto any = [&] { return made[random() % made.size()]; };
        for (int i = 0; i < 60; ++i) {
            const SpacePointId a = any(), b = any(), c = any(), d = any();
            EXPECT_EQ(orient3d(points, a, b, c, d), sign_of_determinant(points, a, b, c, d));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const RationalPoint o = points.exact(a);
                EXPECT_EQ(orient2d(points, axis, a, b, c),
                          sgn(cross(minus(points.exact(b), o), minus(points.exact(c), o), axis)));
                const int order = cmp(points.exact(a)[axis], points.exact(b)[axis]);
                EXPECT_EQ(compare(points, axis, a, b), (order > 0) - (order < 0));
            }
        }
    }
}

/// Walls of several models over the same lines in plan, crossed by a fault: many points lie on one
/// line though they were not constructed on it.
TEST(SpacePoints, SignsOfPointsOnUprightWallsAreThoseOfRationalPoints) {
    std::mt19937_64 random(11);
    const auto part = [&random] { return static_cast<double>(random() % 1000) / 1000; };
    const auto sign_in_view = [](const SpacePoints& points, std::size_t axis,
                                 const std::array<SpacePointId, 3>& of) {
        const RationalPoint o = points.exact(of[0]);
        return sgn(cross(minus(points.exact(of[1]), o), minus(points.exact(of[2]), o), axis));
    };
    int zeros = 0;
    for (int round = 0; round < 20; ++round) {
        SpacePoints points;
        const auto at = [&points](double x, double y, double z) {
            return points.add(SpacePosition{x, y, z});
        };
        // two planes, of which one leans; all walls are between x = 0.1 and 0.9
        const std::array<std::array<SpacePointId, 3>, 2> planes{
            {{at(0.5, -3, -9 + part()), at(0.5 + part() / 9, 3, -9), at(0.5 + part() / 9, 0, 9)},
             {at(0.4, -3, -9), at(0.4 + part() / 9, 3, -9), at(0.4 + part() / 9, 0, 9)}}};
        std::array<std::array<double, 2>, 2> ends{{{0.1, part()}, {0.9, part()}}};
        std::vector<SpacePointId> made;
        for (const auto& [a, b, c] : planes) {
            std::vector<SpacePointId> own;
            for (int i = 0; i < 4; ++i) {
                const SpacePointId p = at(ends[0][0], ends[0][1], part()),
                                   q = at(ends[1][0], ends[1][1], part());
                own.push_back(points.intersection(p, q, a, b, c));
                made.push_back(p);
            }
            // beside the wall
            own.push_back(points.intersection(at(ends[0][0], ends[0][1], part()),
                                              at(0.9, 2 + part(), part()), a, b, c));
            own.push_back(points.intersection(0, own[0], own[4], own[1], a));
            made.insert(made.end(), own.begin(), own.end());
        }
        const auto any = [&] { return made[random() % made.size()]; };
        for (int i = 0; i < 200; ++i) {
            const SpacePointId a = any(), b = any(), c = any(), d = any();
            EXPECT_EQ(orient3d(points, a, b, c, d), sign_of_determinant(points, a, b, c, d));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const int found = orient2d(points, axis, a, b, c);
                EXPECT_EQ(found, sign_in_view(points, axis, {a, b, c}));
                zeros += found == 0 && a != b && a != c && b != c;
            }
        }
    }
    EXPECT_GT(zeros, 100);
}

TEST(SpacePoints, EqualPointsHaveOneNumberWhateverTheyWereMadeOf) {
    SpacePoints points;
    const auto at = [&points](double x, double y, double z) {
        return points.add(SpacePosition{x, y, z});
    };
    const SpacePointId a = at(0, 0, 0), b = at(3, 0, 0), c = at(0, 3, 0), p = at(1, 1, -1),
                       q = at(1, 1, 2);
    // an intersection that is at doubles is those doubles
    EXPECT_EQ(points.intersection(p, q, a, b, c), at(1, 1, 0));
    // one that is not, by its name, by another plane, and in fractions
    const SpacePointId low = at(0, 0, 1), high = at(1, 1, 2), e = at(1. / 3, 0, 0),
                       f = at(0, 1. / 3, 0), top = at(1. / 3, 0, 1);
    const SpacePointId made = points.intersection(low, high, e, f, top);
    EXPECT_EQ(points.intersection(high, low, f, top, e), made);
    EXPECT_EQ(points.intersection(low, high, at(1. / 3, 0, 5), e, f), made);
    EXPECT_EQ(points.add(points.exact(made)), made);
    EXPECT_NE(points.add(points.rounded(low)), made);
    EXPECT_EQ(points.add(points.rounded(low)), low);
}

class AnEdgeAndATriangle : public testing::Test {
protected:
    SpacePointId at(double x, double y, double z) { return points.add(SpacePosition{x, y, z}); }
    SpacePoints points;
    SpacePointId a = at(0, 0, 0), b = at(3, 0, 0), c = at(0, 3, 3);
};

TEST_F(AnEdgeAndATriangle, MeetWhereTheyDo) {
    // the triangle lies in z = y; the edge from (1, 1, 0) to (1, 0, 3) has y = 1 - t, z = 3 t
    const SpacePointId p = points.intersection(at(1, 1, 0), at(1, 0, 3), a, b, c);
    EXPECT_EQ(points.rounded(p), (SpacePosition{1, 0.75, 0.75}));
    EXPECT_TRUE(points.is_double(p));
    const SpacePointId q = points.intersection(at(1, 1, 0), at(1, 0, 2), a, b, c);
    EXPECT_EQ(points.exact(q), (RationalPoint{1, mpq_class(2, 3), mpq_class(2, 3)}));
    EXPECT_FALSE(points.is_double(q));
    EXPECT_TRUE(points.was_constructed_on(q, at(1, 0, 2), at(1, 1, 0)));
    EXPECT_EQ(orient3d(points, a, b, c, q), 0);
    EXPECT_EQ(orient2d(points, 0, at(1, 1, 0), at(1, 0, 2), q), 0);
    EXPECT_EQ(compare(points, 1, q, p), -1);
}

TEST_F(AnEdgeAndATriangle, LinesOfOnePlaneCrossInAPointOfBoth) {
    const SpacePointId d = at(1, 2, 2), e = at(2, 0, 0);
    const SpacePointId p = points.intersection(2, a, d, c, e);  // y = 2 x and y = 3 - 1.5 x
    EXPECT_EQ(points.exact(p),
              (RationalPoint{mpq_class(6, 7), mpq_class(12, 7), mpq_class(12, 7)}));
    EXPECT_EQ(points.intersection(1, e, c, d, a), p);
    EXPECT_TRUE(points.was_constructed_on(p, d, a));
    EXPECT_TRUE(points.was_constructed_on(p, c, e));
    EXPECT_FALSE(points.was_constructed_on(p, a, c));
    EXPECT_EQ(orient2d(points, 2, a, d, p), 0);
    EXPECT_EQ(orient3d(points, a, b, c, p), 0);
    EXPECT_EQ(orient3d(points, a, b, at(0, 3, 4), p),
              -orient3d(points, a, b, at(0, 3, 4), at(0, 3, 9)));
}

TEST_F(AnEdgeAndATriangle, ProjectionsLieInThePlaneAndOnTheLine) {
    const SpacePointId p = at(1, 2, 7);
    EXPECT_EQ(points.projected(2, p, a, b, c), at(1, 2, 2));
    EXPECT_EQ(points.projected(1, p, a, b, c), at(1, 7, 7));
    EXPECT_EQ(points.projected(1, p, a, c), at(0, 2, 2));
}

TEST_F(AnEdgeAndATriangle, ARayCrossesWhatIsAheadOfIt) {
    const std::array triangle{a, b, c};  // turns left seen from above
    EXPECT_EQ(ray_crosses(points, 2, at(1, 0.5, -1), triangle, false), 1);
    EXPECT_EQ(ray_crosses(points, 2, at(1, 0.5, 2), triangle, false), 0);
    EXPECT_EQ(ray_crosses(points, 2, at(5, 0.5, -1), triangle, false), 0);
    EXPECT_EQ(ray_crosses(points, 2, at(1, 0.5, -1), {a, c, b}, false), -1);
    const SpacePointId on = at(1, 0.5, 0.5);
    EXPECT_EQ(ray_crosses(points, 2, on, triangle, true), 1);
    EXPECT_EQ(ray_crosses(points, 2, on, triangle, false), 0);
}

TEST_F(AnEdgeAndATriangle, OfTwoTrianglesWithAnEdgeARayThroughItCrossesOne) {
    const SpacePointId d = at(3, 3, 3), p = at(1.5, 1.5, -1);  // above it the edge from b to c
    const int one = ray_crosses(points, 2, p, {a, b, c}, false);
    const int other = ray_crosses(points, 2, p, {b, d, c}, false);
    EXPECT_EQ(one + other, 1);
}

}  // namespace
}  // namespace realmodel::exact
