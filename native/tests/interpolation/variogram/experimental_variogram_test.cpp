// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/experimental_variogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "../dense_kriging.hpp"

namespace realmodel::interpolation {
namespace {

TEST(ExperimentalVariogram, OfThreePointsByHand) {
    // Distances 3, 4 and 5. The spacing, the median of the nearest distances, is 3, so that pairs
    // within 4.5 count; the first class ends at 3.75, the second 1.25 times as far.
    const ExperimentalVariogram e =
        experimental_variogram(Points{{0, 0, 1}, {3, 0, 3}, {0, 4, 6}}, {});
    EXPECT_EQ(e.pairs, (std::vector<std::int64_t>{1, 1}));
    EXPECT_EQ(e.lags, (std::vector<double>{3, 4}));
    EXPECT_EQ(e.gamma, (std::vector<double>{2, 12.5}));  // (3 - 1)^2 / 2, (6 - 1)^2 / 2
}

TEST(ExperimentalVariogram, OfALineOfPoints) {
    // z = x at 0 .. 40: gamma(h) = h^2 / 2, out to half the extent.
    Points points;
    for (int i = 0; i <= 40; ++i)
        points.push_back({1.0 * i, 0, 1.0 * i});
    const ExperimentalVariogram e = experimental_variogram(points, {});
    ASSERT_GT(e.lags.size(), 4U);
    EXPECT_EQ(e.lags[0], 1);
    EXPECT_EQ(e.gamma[0], 0.5);
    EXPECT_EQ(e.pairs[0], 40);
    for (std::size_t i = 0; i < e.lags.size(); ++i) {
        EXPECT_GE(e.gamma[i], 0.5 * e.lags[i] * e.lags[i] - 1e-9);  // means of squares
        EXPECT_LE(e.lags[i], 20);
    }
    // Pairs of distances 1 .. 20, less what is left over at the end.
    EXPECT_LE(std::accumulate(e.pairs.begin(), e.pairs.end(), std::int64_t{0}), 20 * 41 - 210);
    EXPECT_TRUE(experimental_variogram(Points{{1, 1, 1}}, {}).lags.empty());
}

TEST(ExperimentalVariogram, DistancesUnderAnAnisotropy) {
    const Points points{{0, 0, 0}, {0, 6, 0}, {2, 0, 0}};
    // Longest toward north: what lies east counts three times.
    const IsotropicSpace space({3, 0});
    const PlanPosition from = space({0, 0}), north = space({0, 6}), east = space({2, 0});
    EXPECT_NEAR(std::hypot(north[0] - from[0], north[1] - from[1]), 6, 1e-14);
    EXPECT_NEAR(std::hypot(east[0] - from[0], east[1] - from[1]), 6, 1e-14);
    EXPECT_NEAR(ManyPoints(points).diagonal(space), 6 * std::sqrt(2), 1e-14);
}

}  // namespace
}  // namespace realmodel::interpolation
