// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/ray_boxes.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace realmodel::arrangement {
namespace {

using spatial::Box;

TEST(RayBoxes, ARayGoesFromItsPointToTheEnd) {
    exact::SpacePoints points;
    const Box ray = ray_box(points, points.add(exact::SpacePosition{1, 2, 3}), 1);
    EXPECT_EQ(ray.low, (Box::Position{1, 2, 3}));
    EXPECT_EQ(ray.high, (Box::Position{1, HUGE_VAL, 3}));
}

TEST(RayBoxes, AreFoundInOrderWithATreeAsWithout) {
    Array<Box> boxes;
    for (int i = 0; i < 100; ++i) {
        const double x = i % 10, z = 99 - i;
        boxes.push_back({{x, 0, z}, {x + 1, 1, z + 1}});
    }
    RayBoxes rays(boxes);
    exact::SpacePoints points;
    for (int n = 0; n < 40; ++n) {  // a tree is made on the way
        const Box ray = ray_box(points, points.add(exact::SpacePosition{4.5, 0.5, 50.5}), 2);
        EXPECT_EQ(rays.find(ray, nullptr), (std::vector<std::int32_t>{4, 14, 24, 34, 44}));
    }
}

TEST(RayBoxes, OfAPointThatNoDoubleIsItMeetsWhatThePointIsIn) {
    exact::SpacePoints points;
    const mpq_class third(1, 3);
    const auto p = points.add(exact::RationalPoint{third, third, third});
    const double x = points.rounded(p)[0];
    ASSERT_LT(mpq_class(x), third);  // rounded down: the box begins there, the point is in it
    RayBoxes rays(Array<Box>{Box{{x, x, 0}, {1, 1, 1}}, Box{{0, 0, 0}, {x, x, 1}}});
    EXPECT_EQ(rays.find(ray_box(points, p, 2), nullptr), (std::vector<std::int32_t>{0, 1}));
}

}  // namespace
}  // namespace realmodel::arrangement
