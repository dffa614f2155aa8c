// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/floating_point.hpp"

namespace realmodel::exact {
namespace {

using Position = std::array<double, 2>;

TEST(Orient2d, IsTheTurnFromOneToTheNext) {
    EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
    EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
    EXPECT_EQ(orient2d({0, 0}, {1, 2}, {3, 6}), 0);
    EXPECT_EQ(orient2d({0, 0}, {3, 6}, {1, 2}), 0);
    EXPECT_EQ(orient2d({1, 2}, {1, 2}, {3, 5}), 0);
}

TEST(Orient2d, BesideADiagonalEveryUnitInTheLastPlaceCounts) {
    // the grid of L. Kettner et al. 2008, on which rounded determinants are wrong all over
    for (int x = 0; x < 16; ++x) {
        for (int y = 0; y < 16; ++y) {
            const Position p{0.5 + x * 0x1p-53, 0.5 + y * 0x1p-53};
            const int expected = (y > x) - (y < x);
            EXPECT_EQ(orient2d(p, {12, 12}, {24, 24}), expected);
            EXPECT_EQ(orient2d({24, 24}, p, {12, 12}), expected);
            EXPECT_EQ(orient2d({12, 12}, p, {24, 24}), -expected);
        }
    }
}

TEST(Orient2d, IsExactWhereCoordinatesAreNoDecimals) {
    EXPECT_EQ(orient2d({0.1, 0.1}, {0.2, 0.2}, {0.4, 0.4}), 0);
    EXPECT_EQ(orient2d({0.1, 0.1}, {0.2, 0.2}, {0.4, moved_by_ulps(0.4, 1)}), 1);
    EXPECT_EQ(orient2d({0.1, 0.1}, {0.2, 0.2}, {0.4, moved_by_ulps(0.4, -1)}), -1);
}

TEST(Orient2d, AlongAnAxis) {
    EXPECT_EQ(orient2d({0.1, 0.3}, {0.1, 0.7}, {0.1, 0.4}), 0);
    EXPECT_EQ(orient2d({0.3, 0.1}, {0.7, 0.1}, {0.4, 0.1}), 0);
    EXPECT_EQ(orient2d({0.3, 0.1}, {0.7, 0.1}, {0.4, moved_by_ulps(0.1, 1)}), 1);
}

TEST(Orient2d, FarFromTheOriginAStepIsStillSeen) {
    const double x = 4567890.1, y = 5678901.2;
    const Position a{x, y}, b{x + 1e6, y + 1e6};
    const double dx = b[0] - a[0], dy = b[1] - a[1];  // exact differences
    const Position c{a[0] + dx / 2, a[1] + dy / 2};
    EXPECT_EQ(orient2d(a, c, {c[0], moved_by_ulps(c[1], 1)}), 1);
    EXPECT_EQ(orient2d(a, {c[0], moved_by_ulps(c[1], 1)}, b), -1);
    EXPECT_EQ(orient2d(a, {c[0], moved_by_ulps(c[1], -1)}, b), 1);
}

TEST(Orient2d, ProductsMayOverflowOrUnderflow) {
    EXPECT_EQ(orient2d({1e-300, 0}, {0, 1e-300}, {0, 0}), 1);
    EXPECT_EQ(orient2d({0, 0}, {5e-324, 0}, {0, 5e-324}), 1);
    EXPECT_EQ(orient2d({0, 0}, {1e300, 1e300}, {1e301, moved_by_ulps(1e301, 1)}), 1);
    EXPECT_EQ(orient2d({-1e308, 0}, {1e308, 1}, {1e308, 1.5}), 1);
    EXPECT_EQ(orient2d({-1e300, -1e300}, {1e-300, 1e-300}, {1e300, 1e300}), 0);
}

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

TEST(InOneLine, IsExactInSpace) {
    EXPECT_TRUE(in_one_line({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
    EXPECT_TRUE(in_one_line({0, 0, 0}, {1, 1, 1}, {0, 0, 0}));
    EXPECT_FALSE(in_one_line({0, 0, 0}, {1, 1, 1}, {3, 3, std::nextafter(3.0, 4.0)}));
}

}  // namespace
}  // namespace realmodel::exact
