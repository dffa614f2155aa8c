// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/triangle_pieces.hpp"

#include <gtest/gtest.h>

#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

class TwoSquares : public testing::Test {
protected:
    std::vector<std::int32_t> found(const spatial::Box& near) const {
        std::vector<std::int32_t> inputs;
        pieces.find_inputs(near, [&inputs](std::int32_t input) { inputs.push_back(input); });
        std::sort(inputs.begin(), inputs.end());
        return inputs;
    }
    const Mesh p = square({0, 0, 0}, 2), q = square({0, 0, 1}, 2);
    TrianglePieces pieces{{p.view(), q.view()}, {1}};
};

TEST_F(TwoSquares, AreInputsOfTwoSourcesInARow) {
    EXPECT_EQ(pieces.input_count(), 4U);
    EXPECT_EQ(pieces.source(1), 0);
    EXPECT_EQ(pieces.source(2), 1);
    EXPECT_EQ(pieces.row(3), 1);
    EXPECT_TRUE(pieces.are_whole());
    EXPECT_TRUE((pieces[{3, 0}].is_fresh));
    EXPECT_EQ(pieces.largest_coordinate(), 2);
}

TEST_F(TwoSquares, AnInputMayBeDividedAndIsStillFound) {
    const TriangleCorners whole = pieces.of(0)[0].corners;
    const SpacePointId middle = pieces.points.add(exact::SpacePosition{1, 1, 0});
    pieces.replace(0,
                   {{{whole[0], whole[1], middle}, true}, {{whole[0], middle, whole[2]}, false}});
    EXPECT_FALSE(pieces.are_whole());
    ASSERT_EQ(pieces.of(0).size(), 2U);
    EXPECT_EQ((pieces[{0, 1}].corners[1]), middle);
    EXPECT_EQ(pieces.of(1).size(), 1U);
    int near = 0;
    pieces.find({{0, 1.5, 0}, {0.1, 2, 0}},
                [&](const TrianglePiece& piece) { near += piece.corners[2] == whole[2]; });
    EXPECT_EQ(near, 2);  // a part of the first, and the second
}

TEST_F(TwoSquares, WhatMayHaveMovedIsLookedForFartherAway) {
    const spatial::Box below{{0, 0, -0.5}, {2, 2, -0.25}};
    EXPECT_TRUE(found(below).empty());
    pieces.moved_by(0.25);
    EXPECT_EQ(found(below), (std::vector<std::int32_t>{0, 1}));
}

TEST(InOrder, TellsWhetherCornersAreTurnedOver) {
    const SpacePointId a(0), b(1), c(2);
    EXPECT_EQ(in_order({b, c, a}), std::pair(TriangleCorners{a, b, c}, false));
    EXPECT_EQ(in_order({b, a, c}), std::pair(TriangleCorners{a, b, c}, true));
}

}  // namespace
}  // namespace realmodel::booleans
