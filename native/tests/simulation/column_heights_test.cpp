// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/column_heights.hpp"

#include <gtest/gtest.h>

#include "realmodel/base/errors.hpp"
#include "towers.hpp"

namespace realmodel::simulation {
namespace {

std::vector<double> levels(const ColumnHeights& heights, std::size_t point) {
    const auto own = heights.levels(point);
    return {own.begin(), own.end()};
}

TEST(RockBlocksTest, BlocksOfOneRockMassStandTogether) {
    const std::vector<std::int32_t> rocks{0, 0, 2}, mixed{0, 1, 0};
    const RockBlocks blocks(rocks);
    EXPECT_EQ(blocks.first, (std::vector<std::int32_t>{0, 2, 2, 3}));
    EXPECT_EQ(blocks.most(), 2);
    EXPECT_THROW(RockBlocks{mixed}, InputError);
}

TEST(ColumnHeightsTest, TopsOfBlocksAndTheirSurfaces) {
    const Tower tower({0, 5, 9});
    const std::vector<std::int32_t> rocks{0, 0};
    const std::vector<PlanPoint> points{{3, 2}, {12, 2}, {5, 3}};
    const ColumnHeights heights(tower.view, RockBlocks(rocks), points, {1, nullptr});
    EXPECT_EQ(heights.rock(0), 0);
    EXPECT_EQ(heights.rock(1), ColumnHeights::kOutside);
    EXPECT_EQ(levels(heights, 0), (std::vector<double>{0, 5, 9}));
    EXPECT_EQ(heights.surfaces(0)[0], kBase);
    EXPECT_EQ(heights.surfaces(0)[1], 0);
    EXPECT_EQ(heights.surfaces(0)[2], 1);
}

TEST(ColumnHeightsTest, ABlockThatIsAbsentHasNoThickness) {
    Tower tower({0, 5, 9});
    tower.block = {0, 2};
    tower.view.cell_block = tower.block;
    const std::vector<std::int32_t> rocks{0, 0, 0};
    const std::vector<PlanPoint> points{{3, 2}};
    const ColumnHeights heights(tower.view, RockBlocks(rocks), points, {1, nullptr});
    EXPECT_EQ(levels(heights, 0), (std::vector<double>{0, 5, 5, 9}));
}

TEST(ColumnHeightsTest, ABlockWithoutATopIsIncomplete) {
    Tower tower({0, 5, 9});
    tower.surface[5] = kWall;  // what lies between the two
    const std::vector<std::int32_t> rocks{0, 0};
    const std::vector<PlanPoint> points{{3, 2}};
    const ColumnHeights heights(tower.view, RockBlocks(rocks), points, {1, nullptr});
    EXPECT_EQ(heights.rock(0), ColumnHeights::kIncomplete);
}

TEST(ColumnHeightsTest, FacesAreUprightOrFaceUpOrDown) {
    const Tower tower({0, 5});
    EXPECT_FALSE(is_vertical(tower.view, 0));
    EXPECT_FALSE(faces_up(tower.view, 0));
    EXPECT_TRUE(is_vertical(tower.view, 1));
    EXPECT_TRUE(faces_up(tower.view, 5));
}

}  // namespace
}  // namespace realmodel::simulation
