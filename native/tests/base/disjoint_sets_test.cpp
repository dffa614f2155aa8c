// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "base/parallel_counts.hpp"

namespace realmodel {
namespace {

TEST(DisjointSets, TheLeastMemberStandsForAll) {
    DisjointSets parts(6);
    parts.join(5, 3);
    parts.join(4, 5);
    parts.join(0, 1);
    parts.join(4, 4);
    for (const std::int32_t i : {3, 4, 5})
        EXPECT_EQ(parts.find(i), 3);
    EXPECT_EQ(parts.find(1), 0);
    EXPECT_EQ(parts.find(2), 2);
    parts.join(1, 4);
    EXPECT_EQ(parts.find(5), 0);
}

TEST(DisjointSets, ManyThreadsJoinTheSameSets) {
    constexpr std::size_t kCount = 20000, kPairs = 18000;
    std::mt19937_64 random(7);
    std::uniform_int_distribution<std::int32_t> any(0, static_cast<std::int32_t>(kCount) - 1);
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs(kPairs);
    for (auto& pair : pairs)
        pair = {any(random), any(random)};
    DisjointSets expected(kCount), parts(kCount);
    for (const auto& [a, b] : pairs)
        expected.join(a, b);
    parallel_ranges(kPairs, 64, {4, nullptr}, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            parts.join(pairs[i].first, pairs[i].second);
            // between two questions another thread may join the set to one with a lower member
            EXPECT_LE(parts.find(pairs[i].second), pairs[i].first);
        }
    });
    std::size_t large = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
        const auto member = static_cast<std::int32_t>(i);
        ASSERT_EQ(parts.find(member), expected.find(member));
        large += parts.find(member) == parts.find(0) ? 1 : 0;
    }
    EXPECT_GT(large, 1000u);  // so that threads did meet in one set
}

}  // namespace
}  // namespace realmodel
