// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "simulation/element_quality.hpp"

namespace realmodel::simulation {
namespace {

/// The side of the unit cube at y = 0.
const ElementFace kSide = lateral_face({0, 0}, {1, 0}, {0, 0}, {1, 1});

TEST(FaceQualityTest, SidesOfColumns) {
    EXPECT_EQ(kSide.area, (Vec3{0, -1, 0}));
    EXPECT_EQ(kSide.center, (Vec3{0.5, 0, 0.5}));
    const ElementFace triangle = lateral_face({0, 0}, {3, 0}, {0, 0}, {0, 3});
    EXPECT_EQ(triangle.area, (Vec3{0, -4.5, 0}));
    EXPECT_EQ(triangle.center, (Vec3{2, 0, 1}));
}

TEST(FaceQualityTest, SkewnessIsTheDistanceFromTheCenterOverThatOfTheEdge) {
    EXPECT_EQ(inner_skewness(kSide, {0.5, 0.5, 0.5}, {0.5, -0.5, 0.5}), 0);
    EXPECT_DOUBLE_EQ(inner_skewness(kSide, {2.5, 0.5, 0.5}, {2.5, -0.5, 0.5}), 4);
    EXPECT_EQ(outer_skewness(kSide, {0.5, 0.5, 0.5}), 0);
    EXPECT_DOUBLE_EQ(outer_skewness(kSide, {1.5, 0.5, 0.5}), 2);
}

TEST(FaceQualityTest, FacesThatCheckMeshFails) {
    const ElementBody own{{0.5, 0.5, 0.5}, 1};
    EXPECT_FALSE(is_bad(kSide, own, {{0.5, -0.5, 0.5}, 1}));
    EXPECT_TRUE(is_bad(kSide, own, {{0.5, -0.5, 4.5}, 1}));     // the line leans
    EXPECT_TRUE(is_bad(kSide, own, {{0.5, -0.01, 0.5}, 1}));    // it is crossed near its end
    EXPECT_TRUE(is_bad(kSide, own, {{0.5, -0.5, 0.5}, 0.01}));  // one is much smaller
}

TEST(FaceQualityTest, DeterminantOfACubeIsOneAndOfFacesInTwoDirectionsNone) {
    std::vector<Vec3> areas{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    EXPECT_DOUBLE_EQ(determinant_of(areas), 1);
    areas.resize(4);
    EXPECT_EQ(determinant_of(areas), 0);
    EXPECT_EQ(determinant_of({}), 0);
}

}  // namespace
}  // namespace realmodel::simulation
