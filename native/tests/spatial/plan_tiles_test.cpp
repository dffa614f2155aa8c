// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/plan_tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
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

TEST(HilbertOrder, GoesFromCellToNeighboringCell) {
    std::vector<PlanPosition> nodes;
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j)
            nodes.push_back({3.0 * j, 3.0 * i});
    }
    const std::vector<std::uint32_t> order = along_hilbert_curve(nodes);
    std::vector<bool> seen(nodes.size(), false);
    double length = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        ASSERT_FALSE(seen[order[k]]);
        seen[order[k]] = true;
        if (k == 0) continue;
        const PlanPosition &a = nodes[order[k - 1]], &b = nodes[order[k]];
        length += std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]);
    }
    // The cells of the curve are not quite those of the grid: a few steps are of two cells.
    EXPECT_LT(length, 1.05 * 3 * static_cast<double>(nodes.size()));
    EXPECT_TRUE(along_hilbert_curve({}).empty());
    EXPECT_EQ(along_hilbert_curve(std::vector<PlanPosition>{{1, 1}, {1, 1}}),
              (std::vector<std::uint32_t>{0, 1}));
}

std::vector<std::size_t> within(const PointBins& bins, const PlanPosition& low,
                                const PlanPosition& high) {
    std::vector<std::size_t> found;
    bins.within({low[0], low[1], high[0], high[1]},
                [&](std::size_t i, const PlanPosition&) { found.push_back(i); });
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
    std::vector<PlanPosition> points(500);
    for (auto& p : points)
        p = {at(random), 4.5e6 + at(random)};
    const PointBins bins(points);
    for (int box = 0; box < 100; ++box) {
        PlanPosition low{at(random), 4.5e6 + at(random)}, high = low;
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

bool meet(const TileSpan& a, const TileSpan& b) {
    return a.left <= b.right && b.left <= a.right && a.low <= b.high && b.low <= a.high;
}

class RandomSpans {
public:
    /// Of up to `length` columns and rows.
    TileSpan next(std::int32_t length) {
        const auto [left, right] = stretch(length, 30);
        const auto [low, high] = stretch(length, 20);
        return {left, right, low, high};
    }

private:
    std::pair<std::int32_t, std::int32_t> stretch(std::int32_t length, std::int32_t count) {
        const auto from = std::uniform_int_distribution(0, count - 1)(random_);
        const auto beyond = std::uniform_int_distribution(0, length - 1)(random_);
        return {from, std::min(from + beyond, count - 1)};
    }
    std::mt19937 random_{1};
};

TEST(TileBins, FindsEverythingThatMeetsTheSpan) {
    const PlanTiles tiles({0, 0, 30, 20}, 600);
    ASSERT_EQ(tiles.columns(), 30u);
    ASSERT_EQ(tiles.rows(), 20u);
    RandomSpans random;
    for (const std::int32_t longest : {1, 5, 6, 25}) {  // small ones only, then larger ones too
        std::vector<TileSpan> things;
        for (int i = 0; i < 1500; ++i)
            things.push_back(random.next(longest));
        const auto span_of = [&](std::size_t i) { return i % 10 == 3 ? nullptr : &things[i]; };
        const TileSpan wanted{5, 25, 2, 17};
        std::vector<std::uint8_t> is_wanted(tiles.size(), 0);
        tiles.for_each(wanted, [&](std::size_t tile) { is_wanted[tile] = 1; });
        const TileBins bins(tiles, is_wanted, things.size(), span_of, {3, nullptr});
        for (int query = 0; query < 100; ++query) {
            TileSpan span = random.next(4);
            if (!meet(span, wanted)) continue;
            span = {std::max(span.left, wanted.left), std::min(span.right, wanted.right),
                    std::max(span.low, wanted.low), std::min(span.high, wanted.high)};
            std::set<std::int32_t> found;
            EXPECT_TRUE(bins.all(span, [&](std::int32_t i) { return found.insert(i), true; }));
            for (std::size_t i = 0; i < things.size(); ++i) {
                const bool is_found = found.contains(static_cast<std::int32_t>(i));
                if (i % 10 == 3) {
                    EXPECT_FALSE(is_found);
                } else if (meet(span, things[i])) {
                    EXPECT_TRUE(is_found) << i << " of up to " << longest;
                }
            }
        }
    }
}

TEST(TileBins, StopsWhereTheTestFails) {
    const PlanTiles tiles({0, 0, 30, 20}, 600);
    const std::vector<TileSpan> things{{0, 1, 0, 1}, {1, 1, 1, 1}, {0, 20, 0, 15}};
    const TileBins bins(tiles, std::vector<std::uint8_t>(tiles.size(), 1), things.size(),
                        [&](std::size_t i) { return &things[i]; }, {1, nullptr});
    for (const std::int32_t last : {0, 1, 2}) {
        bool asked_again = false, failed = false;
        EXPECT_FALSE(bins.all({1, 1, 1, 1}, [&](std::int32_t i) {
            asked_again |= failed;
            failed |= i == last;
            return i != last;
        }));
        EXPECT_FALSE(asked_again);
    }
    EXPECT_TRUE(bins.all({25, 26, 16, 17}, [](std::int32_t) { return false; }));
}

}  // namespace
}  // namespace realmodel::spatial
