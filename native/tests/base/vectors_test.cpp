// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/vectors.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace realmodel {
namespace {

static_assert(cross(Vec2{1, 0}, Vec2{0, 1}) == 1);
static_assert(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}) == Vec3{0, 0, 1});
static_assert(twice_area({0, 0}, {3, 0}, {0, 2}) == 6);
static_assert(sixfold_volume({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}) == 1);
static_assert(moved(Vec3{1, 2, 3}, 2, Vec3{1, 0, -1}) == Vec3{3, 2, 1});

TEST(VectorsTest, LengthsAndDistances) {
    EXPECT_EQ(length(Vec2{3, -4}), 5);
    EXPECT_EQ(length(Vec3{2, 3, 6}), 7);
    EXPECT_EQ(unit(Vec3{0, 0, -4}), (Vec3{0, 0, -1}));
    EXPECT_EQ(unit(Vec3{}), Vec3{});
    EXPECT_EQ(squared_distance({1, 1}, {4, 5}), 25);
    EXPECT_EQ(distance({1e200, 0}, {-1e200, 0}), 2e200);
}

TEST(VectorsTest, PerpendicularVectors) {
    for (const Vec3& v : {Vec3{0, 0, 2}, {3, -1, 0}, {1e-3, 5, 7}}) {
        EXPECT_NEAR(dot(perpendicular(v), v), 0, 1e-15);
        EXPECT_NEAR(length(perpendicular(v)), 1, 1e-15);
    }
}

TEST(VectorsTest, NearestPointOfASegment) {
    EXPECT_EQ(nearest_share({0, 0}, {4, 0}, {1, 7}), 0.25);
    EXPECT_EQ(nearest_share({0, 0}, {4, 0}, {-1, 0}), 0);
    EXPECT_EQ(nearest_share({0, 0}, {4, 0}, {9, 0}), 1);
    EXPECT_EQ(nearest_share({2, 2}, {2, 2}, {9, 0}), 0);
}

TEST(VectorsTest, NormalOfAPolygon) {
    const std::vector<Vec3> notched{{0, 0, 5}, {2, 0, 5}, {2, 2, 5}, {1, 1, 5}, {0, 2, 5}};
    EXPECT_EQ(polygon_normal(notched), (Vec3{0, 0, 6}));
    EXPECT_EQ(polygon_normal(std::vector<Vec3>{{1, 2, 3}}), Vec3{});
}

}  // namespace
}  // namespace realmodel
