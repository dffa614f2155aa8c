// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/nearest_side.hpp"

#include <gtest/gtest.h>

namespace realmodel::cutting {
namespace {

/// Two slopes that meet in a ridge along y at x = 0, height 0.
const Cutter kRidge{{{0, -9, 0}, {0, 9, 0}, {3, 0, -9}, {-3, 0, -9}}, {{0, 2, 1}, {0, 1, 3}}};

TEST(NearestSide, TheNearestTriangleTellsTheSide) {
    EXPECT_EQ(NearestSide(kRidge)({0.25, 0, 5}), kAbove);
    EXPECT_EQ(NearestSide(kRidge)({-4, 0, -3}), kAbove);
    EXPECT_EQ(NearestSide(kRidge)({0.25, 0, -5}), kBelow);
    EXPECT_EQ(NearestSide(kRidge)({-0.25, 0, -5}), kBelow);
}

TEST(NearestSide, BeyondItsBorderTheTriangleSeenMostSquarelyTellsTheSide) {
    // nearest is the corner in common; the upright triangle is seen almost along itself
    const Cutter bent{{{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, -1, 1}},
                      {{0, 3, 2}, {0, 2, 1}, {0, 3, 2}}};
    EXPECT_EQ(NearestSide(bent)({-1, 0.8, 0.5}), kAbove);
    EXPECT_EQ(NearestSide(bent)({-1, 0.8, -0.5}), kBelow);
    EXPECT_EQ(NearestSide(bent)({-1, 0, 0.5}), kBelow);  // it is that one's turn
}

TEST(NearestSide, OfLimbsThatAreNearlyOneTheNearerTellsTheSide) {
    // a level sheet that turns back under itself, as far away as the last place of 1
    for (const double gap : {1e-3, 1e-10, 1e-15, 0x1p-53}) {
        const Cutter fold{{{0, 0, 0}, {8, -8, 0}, {8, 8, 0}, {8, -8, -gap}, {8, 8, -gap}},
                          {{0, 1, 2}, {0, 4, 3}}};
        const NearestSide side(fold);
        for (const double x : {1.0, 2.5, 4.0}) {
            EXPECT_EQ(side({x, 0.25, 1}), kAbove) << gap;
            EXPECT_EQ(side({x, 0.25, -1}), kAbove) << gap;  // the lower limb is upside down
            EXPECT_EQ(side({x, 0.25, -gap * x / 16}), kBelow) << gap;
        }
    }
}

TEST(NearestSide, ABorderIsNearestWhereItsPointIs) {
    const NearestSide side(kRidge);
    const auto is_at_border = [&side](const Position& p) {
        bool at_border = false;
        side(p, &at_border);
        return at_border;
    };
    EXPECT_FALSE(is_at_border({0, 0, 1}));   // the ridge
    EXPECT_TRUE(is_at_border({0, 9, 1}));    // its end
    EXPECT_TRUE(is_at_border({4, 0, -12}));  // beyond a corner
    // the foot is on a border edge, or beside it by less than a millionth of its length
    const Cutter square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    const NearestSide level(square);
    for (const double y : {0.0, -0x1p-60, 0x1p-60, 1e-9}) {
        bool at_border = false;
        EXPECT_EQ(level({0.5, y, 1}, &at_border), kAbove);
        EXPECT_EQ(at_border, y <= 0);
    }
}

TEST(NearestSide, OneUnitInTheLastPlaceOffTheTriangleIsTold) {
    const Cutter slope{{{0, 0, 0}, {3, 0, 1}, {0, 3, 1}}, {{0, 1, 2}}};
    const NearestSide side(slope);
    const double height = 2.0 / 3;  // a little less than the slope at (1, 1)
    EXPECT_EQ(side({1, 1, height}), kBelow);
    EXPECT_EQ(side({1, 1, std::nextafter(height, 1)}), kAbove);
    EXPECT_EQ(side({0.75, 0.75, 0.5}), kAbove);  // on it
}

TEST(NearestSide, OfABallWhereAllOfItIsOnOneSide) {
    const NearestSide ridge(kRidge);
    bool at_border = false;
    const auto of_ball = [&](const Position& center, double radius) {
        return ridge.of_ball(center, radius, at_border);
    };
    EXPECT_EQ(of_ball({0, 0, 1}, 0.25), kAbove);
    EXPECT_EQ(of_ball({0.1, 0, -2.5}, 0.1), kBelow);
    EXPECT_EQ(of_ball({0, 0, 1}, 1.25), std::nullopt);     // it meets the surface
    EXPECT_EQ(of_ball({2, 0, -5.5}, 0.25), std::nullopt);  // some is below one slope alone
    EXPECT_EQ(of_ball({-4, 0, -3}, 0.25), kAbove);
    EXPECT_FALSE(at_border);
    of_ball({0, 8.5, 1}, 0.25);  // a border edge is as near
    EXPECT_TRUE(at_border);
    at_border = false;
    of_ball({0, 20, 1}, 0.25);
    EXPECT_TRUE(at_border);
}

TEST(NearestSide, WithinATetrahedron) {
    const Cutter body{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
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
