// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "cutting/rounding/rounded_parts.hpp"

namespace realmodel::cutting {
namespace {

TEST(FreePosition, IsOneStepAwayAndTakenThen) {
    const Position p{1, 1, 1};
    Positions taken;
    taken.insert(p);
    for (int i = 0; i < 26; ++i) {
        const Position to = free_position_beside(p, Freedom::kAny, taken);
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_LE(std::abs(to[k] - 1), 0x1p-52);
        EXPECT_GE(taken.find(to), 0);
    }
    EXPECT_EQ(taken.size(), 27U);
    const Position next = free_position_beside(p, Freedom::kAny, taken);
    EXPECT_EQ(next[0], 1 - 0x1p-52);  // two steps
}

TEST(FreePosition, OnTheBaseItKeepsItsHeight) {
    Positions taken;
    taken.insert({2, 3, 4});
    for (int i = 0; i < 20; ++i)
        EXPECT_EQ(free_position_beside({2, 3, 4}, Freedom::kLevel, taken)[2], 4);
}

TEST(FreePosition, OnAWallItGoesUpOrDownFirst) {
    Positions taken;
    taken.insert({2, 3, 4});
    for (int i = 0; i < 8; ++i) {
        const Position to = free_position_beside({2, 3, 4}, Freedom::kUpright, taken);
        EXPECT_EQ(to[0], 2);
        EXPECT_EQ(to[1], 3);
    }
    EXPECT_NE(free_position_beside({2, 3, 4}, Freedom::kUpright, taken)[0], 2);
}

}  // namespace
}  // namespace realmodel::cutting
