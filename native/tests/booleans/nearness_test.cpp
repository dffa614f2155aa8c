// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/nearness.hpp"

#include <gtest/gtest.h>

#include "base/floating_point.hpp"

namespace realmodel::booleans {
namespace {

/// The triangle (0, 0, 0), (4, 0, 0), (0, 4, 0), and others near it.
class Near : public testing::Test {
protected:
    SpacePointId at(double x, double y, double z) {
        return points.add(exact::SpacePosition{x, y, z});
    }
    NearFeatures find(const TriangleCorners& other) const {
        NearFeatures found;
        nearness.find(pair_of(level, other), found);
        return found;
    }

    SpacePoints points;
    TriangleCorners level{at(0, 0, 0), at(4, 0, 0), at(0, 4, 0)};
    Nearness nearness{points, 64};
    double little = ulp(4.0);
};

TEST_F(Near, VerticesBecomeOne) {
    const SpacePointId beside = at(4, 0, little);
    const NearFeatures found = find({beside, at(9, 0, 3), at(9, 9, 3)});
    EXPECT_EQ(found.same, std::vector<SpaceEdge>{unordered(level[1], beside)});
}

TEST_F(Near, AVertexIsOnAnEdgeOrOverTheInside) {
    const SpacePointId on = at(2, little, 0), over = at(1, 1, -little);
    const NearFeatures beside = find({on, at(2, -9, 3), at(3, -9, 3)});
    EXPECT_EQ(
        beside.on_edges,
        (std::vector<std::pair<SpaceEdge, SpacePointId>>{{unordered(level[0], level[1]), on}}));
    const NearFeatures above = find({over, at(1, 1, -9), at(1, 2, -9)});
    EXPECT_EQ(above.over, (std::vector<std::pair<TriangleCorners, SpacePointId>>{{level, over}}));
    EXPECT_TRUE(above.same.empty());
}

TEST_F(Near, EdgesThatPassEachOtherHaveACrossing) {
    const TriangleCorners across{at(2, -1, little), at(2, 1, little), at(2, 0, 9)};
    const NearFeatures found = find(across);
    ASSERT_EQ(found.crossings.size(), 1U);
    EXPECT_NEAR(found.crossings[0].at[0], 2, 1e-12);
    EXPECT_NEAR(found.crossings[0].at[1], 0, 1e-12);
}

TEST_F(Near, WhatIsFartherAwayIsNot) {
    EXPECT_TRUE(find({at(1, 1, 1e-9), at(1, 2, 1), at(2, 1, 1)}).empty());
    EXPECT_GT(nearness.distance_at(100), nearness.distance_at(4));
    EXPECT_LT(nearness.distance_at(100), 1e-9);
}

TEST_F(Near, ShallowIsWhatPassesThePlaneByLittle) {
    EXPECT_TRUE(nearness.is_shallow(pair_of(level, {at(1, 1, -little), at(2, 1, 5), at(1, 2, 5)})));
    EXPECT_FALSE(nearness.is_shallow(pair_of(level, {at(1, 1, -1), at(2, 1, 5), at(1, 2, 5)})));
}

TEST_F(Near, APairIsTheSameInEitherOrder) {
    const TriangleCorners other{at(7, 1, 1), at(1, 7, 1), at(1, 1, 7)};
    EXPECT_EQ(pair_of(other, level), pair_of({level[2], level[0], level[1]}, other));
}

}  // namespace
}  // namespace realmodel::booleans
