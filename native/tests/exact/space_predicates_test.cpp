// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/floating_point.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {
namespace {

class SpacePredicates : public testing::Test {
protected:
    SpacePointId at(double x, double y, double z) { return points.add(SpacePosition{x, y, z}); }
    SpacePointId from(double o, double x, double y, double z) { return at(o + x, o + y, o + z); }
    /// The point x, x, x of the diagonal from (o, o, o) where x + y + z = 1 from there: a third,
    /// which is no double.
    SpacePointId third(double o = 0) {
        return points.intersection(from(o, 0, 0, 0), from(o, 1, 1, 1), from(o, 1, 0, 0),
                                   from(o, 0, 1, 0), from(o, 0, 0, 1));
    }
    SpacePoints points;
};

TEST_F(SpacePredicates, Orient3dIsPositiveOnTheSideSeenCounterClockwise) {
    const SpacePointId a = at(0, 0, 0), b = at(1, 0, 0), c = at(0, 1, 0);
    EXPECT_EQ(orient3d(points, a, b, c, at(5, 5, 1)), 1);
    EXPECT_EQ(orient3d(points, a, b, c, at(5, 5, -1)), -1);
    EXPECT_EQ(orient3d(points, a, c, b, at(5, 5, 1)), -1);
    EXPECT_EQ(orient3d(points, a, b, c, at(5, 5, 0)), 0);
}

TEST_F(SpacePredicates, Orient3dSeesOneUnitInTheLastPlace) {
    const double x = 4567890.1, y = 5678901.2, z = 0.1;  // a slope of 1 far from the origin
    const SpacePointId a = at(x, y, z), b = at(x + 64, y, z + 64), c = at(x, y + 64, z);
    const double dx = (x + 64) - x, dz = (z + 64) - z;
    ASSERT_EQ(dx, 64);
    for (const int step : {-1, 0, 1}) {
        const SpacePointId d = at(x + 64, y + 64, moved_by_ulps(z + dz, step));
        EXPECT_EQ(orient3d(points, a, b, c, d), step);
    }
}

TEST_F(SpacePredicates, AThirdIsBetweenTwoDoubles) {
    const SpacePointId p = third();
    const double below = 1.0 / 3;  // the nearest double is less
    EXPECT_EQ(points.rounded(p), (SpacePosition{below, below, below}));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(compare(points, axis, p, at(below, below, below)), 1);
        const double above = moved_by_ulps(below, 1);
        EXPECT_EQ(compare(points, axis, p, at(above, above, above)), -1);
        EXPECT_EQ(compare(points, axis, p, p), 0);
    }
}

TEST_F(SpacePredicates, AConstructedPointLiesInItsPlaneThoughItsDoublesDoNot) {
    for (const double o : {0.0, 4e6}) {
        const SpacePointId p = third(o), doubles = points.add(points.rounded(p));
        // another plane through the same three points and the same line, by other names
        const SpacePointId a = from(o, 2, -1, 0), b = from(o, -1, 2, 0), c = from(o, 0, -1, 2);
        EXPECT_EQ(orient3d(points, a, b, c, p), 0);
        EXPECT_NE(orient3d(points, a, b, c, doubles), 0);
        EXPECT_EQ(orient2d(points, 2, from(o, -1, -1, 0), from(o, 2, 2, 0), p), 0);
        EXPECT_EQ(orient2d(points, 2, from(o, 0, 0, 0), from(o, 1, 1 + 0x1p-30, 1), p), -1);
    }
}

TEST_F(SpacePredicates, TwoConstructedPointsAreKnownToBeOnOneLineWithAVertex) {
    // on the diagonal, but made as where the way from (0, 0, 2) to (1, 1, 0) passes x = z
    const SpacePointId o = at(0, 0, 0), p = third(),
                       q = points.intersection(at(0, 0, 2), at(1, 1, 0), o, at(1, 0, 1),
                                               at(0, 1, 0));
    EXPECT_EQ(points.exact(q)[0], mpq_class(2, 3));
    EXPECT_EQ(orient2d(points, 0, o, p, q), 0);
    EXPECT_EQ(orient3d(points, o, at(5, 1, 0), p, q), 0);
    EXPECT_EQ(compare(points, p, q), -1);
    const SpacePointId aside = at(1, 1 + 0x1p-40, 1);
    EXPECT_EQ(orient2d(points, 2, aside, p, q), 1);
}

TEST_F(SpacePredicates, PointsConstructedOfConstructedOnesAreKnownExactly) {
    const SpacePointId p = third(), o = at(0, 0, 0), a = at(1, 0, 0);
    const SpacePointId ninth = points.middle({o, o, p});  // given by rational numbers
    EXPECT_EQ(points.exact(ninth)[1], mpq_class(1, 9));
    EXPECT_EQ(orient3d(points, o, a, p, ninth), 0);
    EXPECT_EQ(orient2d(points, 1, o, ninth, p), 0);
    EXPECT_EQ(compare(points, 0, ninth, p), -1);
    EXPECT_EQ(orient2d(points, 2, o, a, ninth), 1);
}

TEST_F(SpacePredicates, Orient2dIsSeenFromThePositiveEndOfTheAxis) {
    const SpacePointId o = at(0, 0, 0);
    EXPECT_EQ(orient2d(points, 2, o, at(1, 0, 7), at(0, 1, -7)), 1);
    EXPECT_EQ(orient2d(points, 0, o, at(7, 1, 0), at(-7, 0, 1)), 1);
    EXPECT_EQ(orient2d(points, 1, o, at(0, 7, 1), at(1, -7, 0)), 1);
    EXPECT_EQ(orient2d(points, 1, o, at(1, 7, 0), at(0, -7, 1)), -1);
}

TEST_F(SpacePredicates, PointsAreOrderedByXThenYThenZ) {
    EXPECT_EQ(compare(points, at(1, 9, 9), at(2, 0, 0)), -1);
    EXPECT_EQ(compare(points, at(1, 2, 0), at(1, 1, 9)), 1);
    EXPECT_EQ(compare(points, at(1, 1, 2), at(1, 1, 3)), -1);
    EXPECT_EQ(compare(points, at(1, 1, 2), at(1, 1, 2)), 0);
}

TEST_F(SpacePredicates, ARayThroughACornerCrossesOneOfTheTrianglesThere) {
    const SpacePointId top = at(0, 0, 0), below = at(0, 0, -1);
    const std::array<SpacePointId, 4> around{at(1, 0, 0), at(0, 1, 0), at(-1, 0, 0), at(0, -1, 0)};
    int sum = 0, crossed = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const int crosses =
            ray_crosses(points, 2, below, {top, around[i], around[(i + 1) % 4]}, false);
        sum += crosses;
        crossed += crosses != 0;
    }
    EXPECT_EQ(crossed, 1);
    EXPECT_EQ(sum, 1);
}

TEST_F(SpacePredicates, ARayAlongATriangleMissesIt) {
    const std::array upright{at(0, 0, 1), at(1, 0, 1), at(0, 0, 2)};
    EXPECT_EQ(ray_crosses(points, 2, at(0.25, 0, 0), upright, false), 0);
    EXPECT_EQ(ray_crosses(points, 2, at(0, 0, 0), upright, true), 0);
}

TEST_F(SpacePredicates, TheFartherPointIsTheOneFartherFromTheLine) {
    const SpacePointId a = at(0, 0, 0), b = at(3, 3, 0), p = at(0, 2, 5), q = at(9, 10, -5);
    EXPECT_TRUE(is_farther(points, 2, a, b, p, q));  // by 2 and by 1 along y
    EXPECT_FALSE(is_farther(points, 2, a, b, q, p));
    EXPECT_FALSE(is_farther(points, 2, a, b, p, at(1, 3, 0)));  // as far
    EXPECT_TRUE(is_farther(points, 2, a, b, at(1, moved_by_ulps(3, 1), 0), p));
}

}  // namespace
}  // namespace realmodel::exact
