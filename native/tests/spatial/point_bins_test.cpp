// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/point_bins.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace realmodel::spatial {
namespace {

std::vector<std::size_t> within(const PointBins& bins, const PointBins::Position& low,
                                const PointBins::Position& high) {
    std::vector<std::size_t> found;
    bins.within({low[0], low[1], high[0], high[1]},
                [&](std::size_t i, const PointBins::Position&) { found.push_back(i); });
    std::sort(found.begin(), found.end());
    return found;
}

TEST(PointBins, BordersOfTheBoxBelongToIt) {
    const PointBins bins({{0, 0}, {1, 0}, {1, 1}, {2, 2}, {1, 1}});
    EXPECT_EQ(within(bins, {1, 0}, {2, 1}), (std::vector<std::size_t>{1, 2, 4}));
    EXPECT_EQ(within(bins, {-5, -5}, {5, 5}), (std::vector<std::size_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(within(bins, {1.25, 0.5}, {1.75, 1.5}), (std::vector<std::size_t>{}));
    EXPECT_EQ(within(bins, {3, 0}, {4, 4}), (std::vector<std::size_t>{}));
}

TEST(PointBins, PointsMayLieOnALineOrAtOnePosition) {
    EXPECT_EQ(within(PointBins({}), {0, 0}, {1, 1}).size(), 0u);
    EXPECT_EQ(within(PointBins({{3, 4}, {3, 4}}), {3, 4}, {3, 4}).size(), 2u);
    const PointBins line({{0, 7}, {1, 7}, {2, 7}, {3, 7}});
    EXPECT_EQ(within(line, {1, 7}, {2, 7}), (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(within(line, {1, 7.5}, {2, 8}), (std::vector<std::size_t>{}));
}

TEST(PointBins, FindsWhatASearchOfAllFinds) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> at(0, 10);
    std::vector<PointBins::Position> points(500);
    for (auto& p : points)
        p = {at(random), 4.5e6 + at(random)};
    const PointBins bins(points);
    for (int box = 0; box < 100; ++box) {
        PointBins::Position low{at(random), 4.5e6 + at(random)}, high = low;
        high[0] += at(random) / 4;
        high[1] += at(random) / 4;
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto& [x, y] = points[i];
            if (x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1]) expected.push_back(i);
        }
        EXPECT_EQ(within(bins, low, high), expected);
    }
}

}  // namespace
}  // namespace realmodel::spatial
