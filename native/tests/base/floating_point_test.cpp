// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/floating_point.hpp"

#include <gtest/gtest.h>

namespace realmodel {
namespace {

TEST(Ulp, IsTheStepToTheNextLargerDouble) {
    EXPECT_EQ(ulp(1.0), 0x1p-52);
    EXPECT_EQ(ulp(-1.5), 0x1p-52);
    EXPECT_EQ(ulp(0.0), 0x1p-1074);
}

TEST(Ulp, StepsGoUpAndDownThroughZero) {
    EXPECT_EQ(moved_by_ulps(1.0, 2), 1.0 + 0x1p-51);
    EXPECT_EQ(moved_by_ulps(1.0, -2), 1.0 - 0x1p-52);
    EXPECT_EQ(moved_by_ulps(0x1p-1074, -2), -0x1p-1074);
    EXPECT_EQ(moved_by_ulps(3.25, 0), 3.25);
}

}  // namespace
}  // namespace realmodel
