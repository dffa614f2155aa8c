// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/nearest_side.hpp"

#include <gtest/gtest.h>

namespace realmodel::cutting {
namespace {

/// Two slopes that meet in a ridge along y at x = 0, height 0.
const CutterSurface kRidge{{{0, -9, 0}, {0, 9, 0}, {3, 0, -9}, {-3, 0, -9}},
                           {{0, 2, 1}, {0, 1, 3}}};

TEST(NearestSide, TheNearestTriangleTellsTheSide) {
    EXPECT_EQ(NearestSide(kRidge)({0.25, 0, 5}), kAbove);
    EXPECT_EQ(NearestSide(kRidge)({-4, 0, -3}), kAbove);
    EXPECT_EQ(NearestSide(kRidge)({0.25, 0, -5}), kBelow);
    EXPECT_EQ(NearestSide(kRidge)({-0.25, 0, -5}), kBelow);
}

TEST(NearestSide, BeyondItsBorderTheTriangleSeenMostSquarelyTellsTheSide) {
    // nearest is the corner in common; the upright triangle is seen almost along itself
    const CutterSurface bent{{{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, -1, 1}},
                             {{0, 3, 2}, {0, 2, 1}, {0, 3, 2}}};
    EXPECT_EQ(NearestSide(bent)({-1, 0.8, 0.5}), kAbove);
    EXPECT_EQ(NearestSide(bent)({-1, 0.8, -0.5}), kBelow);
    EXPECT_EQ(NearestSide(bent)({-1, 0, 0.5}), kBelow);  // it is that one's turn
}

TEST(NearestSide, OneUnitInTheLastPlaceOffTheTriangleIsTold) {
    const CutterSurface slope{{{0, 0, 0}, {3, 0, 1}, {0, 3, 1}}, {{0, 1, 2}}};
    const NearestSide side(slope);
    const double height = 2.0 / 3;  // a little less than the slope at (1, 1)
    EXPECT_EQ(side({1, 1, height}), kBelow);
    EXPECT_EQ(side({1, 1, std::nextafter(height, 1)}), kAbove);
    EXPECT_EQ(side({0.75, 0.75, 0.5}), kAbove);  // on it
}

TEST(NearestSide, OfABallWhereAllOfItIsOnOneSideAndNoBorderIsNear) {
    const NearestSide ridge(kRidge);
    EXPECT_EQ(ridge.of_ball({0, 0, 1}, 0.25), kAbove);
    EXPECT_EQ(ridge.of_ball({0.1, 0, -2.5}, 0.1), kBelow);
    EXPECT_EQ(ridge.of_ball({0, 0, 1}, 1.25), std::nullopt);     // it meets the surface
    EXPECT_EQ(ridge.of_ball({2, 0, -5.5}, 0.25), std::nullopt);  // some is below one slope alone
    EXPECT_EQ(ridge.of_ball({-4, 0, -3}, 0.25), kAbove);
    EXPECT_EQ(ridge.of_ball({0, 8.5, 1}, 0.25), std::nullopt);  // a border edge is as near
    EXPECT_EQ(ridge.of_ball({0, 20, 1}, 0.25), std::nullopt);
}

TEST(NearestSide, WithinATetrahedron) {
    const CutterSurface body{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
                             {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
                             true};
    const NearestSide side(body);
    EXPECT_EQ(side.within({1, 1, 1}), kBelow);
    EXPECT_EQ(side.within({1, 1, 2.5}), kAbove);
    EXPECT_EQ(side.within({1, 1, -1}), kAbove);  // the ray passes through twice
    EXPECT_EQ(side.within({2, 2, -1}), kAbove);  // through edges
}

}  // namespace
}  // namespace realmodel::cutting
