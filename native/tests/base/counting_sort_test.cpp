// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/counting_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/index.hpp"

namespace realmodel {
namespace {

template <class Values>
std::vector<int> listed(const Values& values) {
    return {values.begin(), values.end()};
}

TEST(CountingSort, KeepsTheOrderWithinABucket) {
    const std::vector<std::pair<std::size_t, int>> input{{2, 5}, {0, 7}, {2, 3}, {2, 4}, {0, 1}};
    const auto buckets = bucketize<int>(4, [&](const auto& put) {
        for (const auto& [bucket, value] : input)
            put(bucket, value);
    });
    ASSERT_EQ(buckets.size(), 4u);
    EXPECT_EQ(listed(buckets[0]), (std::vector{7, 1}));
    EXPECT_EQ(listed(buckets[1]), (std::vector<int>{}));
    EXPECT_EQ(listed(buckets[2]), (std::vector{5, 3, 4}));
    EXPECT_EQ(listed(buckets[3]), (std::vector<int>{}));
    EXPECT_EQ(listed(buckets.offsets), (std::vector{0, 2, 2, 5, 5}));
}

TEST(CountingSort, NothingFallsIntoNoBuckets) {
    const auto nothing = [](const auto&) {};
    EXPECT_EQ(bucketize<int>(0, nothing).size(), 0u);
    EXPECT_EQ(bucketize<int>(3, nothing).size(), 3u);
    EXPECT_TRUE(bucketize<int>(3, nothing)[2].empty());
    EXPECT_EQ(Buckets<int>().size(), 0u);
    const auto of_chunk = [](std::size_t, const auto&) {};
    EXPECT_EQ(bucketize_in_order<int>(2, 0, of_chunk, {2, nullptr}).size(), 2u);
    EXPECT_EQ(bucketize_in_any_order<int>(2, 0, of_chunk, {2, nullptr}).size(), 2u);
}

TEST(CountingSort, SeveralThreadsFindTheSame) {
    constexpr std::size_t kChunks = 50, kOfChunk = 1000, kBuckets = 97;
    const auto produce = [](std::size_t chunk, const auto& put) {
        for (std::size_t i = chunk * kOfChunk; i < (chunk + 1) * kOfChunk; ++i) {
            put(i * i % kBuckets, static_cast<int>(i));
            if (i % 3 == 0) put(i % kBuckets, -static_cast<int>(i));  // one item in two buckets
        }
    };
    const auto expected = bucketize<int>(kBuckets, [&](const auto& put) {
        for (std::size_t chunk = 0; chunk < kChunks; ++chunk)
            produce(chunk, put);
    });
    const auto ordered = bucketize_in_order<int>(kBuckets, kChunks, produce, {3, nullptr});
    EXPECT_EQ(ordered.offsets, expected.offsets);
    EXPECT_EQ(ordered.values, expected.values);
    auto any = bucketize_in_any_order<int>(kBuckets, kChunks, produce, {3, nullptr});
    EXPECT_EQ(any.offsets, expected.offsets);
    for (std::size_t b = 0; b < kBuckets; ++b) {
        auto sorted = listed(expected[b]);
        std::sort(sorted.begin(), sorted.end());
        std::sort(any[b].begin(), any[b].end());
        EXPECT_EQ(listed(any[b]), sorted);
    }
    const auto in_order = sorted_in_buckets<int>(kBuckets, kChunks, produce, {3, nullptr});
    EXPECT_EQ(in_order.offsets, expected.offsets);
    EXPECT_EQ(in_order.values, any.values);
}

TEST(Index, IsTheNumberItself) {
    static_assert(index(std::int32_t{7}) == 7u);
    static_assert(index(std::int64_t{1} << 40) == std::size_t{1} << 40);
}

}  // namespace
}  // namespace realmodel
