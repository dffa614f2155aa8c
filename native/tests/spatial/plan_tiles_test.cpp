// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/plan_tiles.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace realmodel::spatial {
namespace {

TEST(PlanBox, AroundAFewPositions) {
    const PlanBox box = box_around(std::vector<PlanPosition>{{3, -1}, {-2, 5}, {0, 0}});
    EXPECT_EQ(box.low_x, -2);
    EXPECT_EQ(box.high_y, 5);
    EXPECT_EQ(box.width(), 5);
    EXPECT_EQ(box.height(), 6);
    EXPECT_TRUE(box.contains({3, 5}));
    EXPECT_FALSE(box.contains({3, 5.5}));
    EXPECT_TRUE(box.widened(0.5).contains({3, 5.5}));
}

TEST(PlanTiles, AreAsSquareAsTheFrameAllows) {
    const PlanTiles tiles({0, 0, 8, 2}, 16);
    EXPECT_EQ(tiles.columns(), 8u);
    EXPECT_EQ(tiles.rows(), 2u);
    EXPECT_EQ(tiles.size(), 16u);
    const PlanTiles line({0, 3, 10, 3}, 5);  // a frame without height
    EXPECT_EQ(line.columns(), 5u);
    EXPECT_EQ(line.rows(), 1u);
    EXPECT_EQ(PlanTiles({0, 0, 1, 1}, 0).size(), 1u);
}

TEST(PlanTiles, WhatLiesBesideTheFrameBelongsToTheNearestTile) {
    const PlanTiles tiles({0, 0, 4, 4}, 16);
    const TileSpan span = tiles.span({-3, 0.5, 1.5, 99});
    EXPECT_EQ(span.left, 0);
    EXPECT_EQ(span.right, 1);
    EXPECT_EQ(span.low, 0);
    EXPECT_EQ(span.high, 3);
    EXPECT_EQ(tiles.column(4), 3);  // the border belongs to the last one
    EXPECT_EQ(tiles.tile(3, 2), 11u);
}

TEST(PlanTiles, SpansAreVisitedRowByRow) {
    const PlanTiles tiles({0, 0, 4, 4}, 16);
    std::vector<std::size_t> visited;
    tiles.for_each({1, 2, 0, 1}, [&](std::size_t tile) { visited.push_back(tile); });
    EXPECT_EQ(visited, (std::vector<std::size_t>{1, 2, 5, 6}));
    EXPECT_TRUE(tiles.any({1, 2, 0, 1}, [](std::size_t tile) { return tile == 6; }));
    EXPECT_FALSE(tiles.any({1, 2, 0, 1}, [](std::size_t tile) { return tile == 9; }));
}

TEST(PlanTiles, CentersInATriangle) {
    const PlanTiles tiles({0, 0, 4, 4}, 16);
    std::vector<std::size_t> visited;
    // x + y <= 2.5: the centers (0.5, 0.5), (1.5, 0.5) and (0.5, 1.5)
    tiles.for_each_center_in({{{0, 0}, {2.5, 0}, {0, 2.5}}},
                             [&](std::size_t tile) { visited.push_back(tile); });
    EXPECT_EQ(visited, (std::vector<std::size_t>{0, 1, 4}));
    tiles.for_each_center_in({{{5, 5}, {6, 5}, {5, 6}}}, [](std::size_t) { FAIL(); });
}

TEST(PlanBox, MeetsWhatItTouches) {
    const PlanBox box{0, 0, 1, 1};
    EXPECT_TRUE(box.meets({1, 1, 2, 2}));
    EXPECT_FALSE(box.meets({1.5, 0, 2, 1}));
    EXPECT_FALSE(box.meets({0, -1, 1, -0.5}));
}

}  // namespace
}  // namespace realmodel::spatial
