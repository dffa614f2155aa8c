// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "strata/conform/walls.hpp"

namespace realmodel::strata {
namespace {

class WallJoiningTest : public testing::Test {
protected:
    auto emit() {
        return [this](const OpenWall& wall) { done_.push_back(wall); };
    }
    WallJoining joining_;
    std::vector<OpenWall> done_;
};

TEST_F(WallJoiningTest, GoesOnBetweenTheSameCells) {
    joining_.add({0, 2}, {1, 3}, 5, 6, true);
    joining_.end_interval(emit());
    joining_.add({2, 4}, {3, 5}, 5, 6, true);
    joining_.end_interval(emit());
    EXPECT_TRUE(done_.empty());
    joining_.end_line(emit());
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].lower, (std::vector<std::int32_t>{0, 2, 4}));
    EXPECT_EQ(done_[0].upper, (std::vector<std::int32_t>{1, 3, 5}));
}

TEST_F(WallJoiningTest, EndsWhereCellsOrTheVerticalEdgeChange) {
    joining_.add({0, 2}, {1, 3}, 5, 6, true);
    joining_.end_interval(emit());
    joining_.add({2, 4}, {3, 5}, 5, 7, true);  // another cell
    joining_.end_interval(emit());
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].right, 6);
    joining_.add({4, 6}, {7, 8}, 5, 7, true);  // another vertex above
    joining_.end_interval(emit());
    ASSERT_EQ(done_.size(), 2u);
    joining_.add({6, 9}, {8, 10}, 5, 7, false);  // not to be joined
    joining_.end_interval(emit());
    joining_.end_line(emit());
    EXPECT_EQ(done_.size(), 4u);
}

TEST_F(WallJoiningTest, SeveralWallsOverOneIntervalGoOnEachForItself) {
    joining_.add({0, 3}, {1, 4}, 1, 2, true);
    joining_.add({1, 4}, {2, 5}, 1, 3, true);
    joining_.end_interval(emit());
    joining_.add({4, 7}, {5, 8}, 1, 3, true);
    joining_.end_interval(emit());
    ASSERT_EQ(done_.size(), 1u);
    EXPECT_EQ(done_[0].right, 2);
    joining_.end_line(emit());
    ASSERT_EQ(done_.size(), 2u);
    EXPECT_EQ(done_[1].lower, (std::vector<std::int32_t>{1, 4, 7}));
}

}  // namespace
}  // namespace realmodel::strata
