// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/tile_bins.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace realmodel::spatial {
namespace {

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
