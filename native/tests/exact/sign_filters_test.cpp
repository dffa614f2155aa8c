// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/sign_filters.hpp"

#include <gtest/gtest.h>

namespace realmodel::exact {
namespace {

TEST(SignFilters, TellClearSigns) {
    EXPECT_EQ(orient2d_filter({0, 0}, {1, 0}, {0, 1}), 1);
    EXPECT_EQ(orient2d_filter({0, 0}, {0, 1}, {1, 0}), -1);
    EXPECT_EQ(orient3d_filter({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
    EXPECT_EQ(orient3d_filter({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
}

TEST(SignFilters, DoNotTellWhatRoundingMayHaveDone) {
    EXPECT_FALSE(orient2d_filter({0, 0}, {1, 1}, {2, 2}));
    EXPECT_FALSE(orient2d_filter({0.1, 0.1}, {0.2, 0.2}, {0.3, 0.3 + 0x1p-54}));
    EXPECT_FALSE(orient3d_filter({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0}));
    // products that underflow
    EXPECT_FALSE(orient2d_filter({0, 0}, {1e-170, 0}, {0, 1e-170}));
    EXPECT_FALSE(orient3d_filter({0, 0, 0}, {1e-162, 0, 0}, {0, 1e-162, 0}, {0, 0, 1e50}));
}

TEST(SignFilters, InexactCoordinatesNeedALargerDeterminant) {
    // the determinant is 2^-40; coordinates of size 1 that are off by `off` may make 8 off of it
    EXPECT_EQ(orient2d_filter({0, 0}, {1, 0}, {1, 0x1p-40}, 0x1p-44), 1);
    EXPECT_FALSE(orient2d_filter({0, 0}, {1, 0}, {1, 0x1p-40}, 0x1p-43));
    EXPECT_EQ(orient3d_filter({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0x1p-40}, 0x1p-45), 1);
    EXPECT_FALSE(orient3d_filter({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0x1p-40}, 0x1p-44));
}

}  // namespace
}  // namespace realmodel::exact
