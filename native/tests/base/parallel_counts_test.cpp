// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel_counts.hpp"

#include <gtest/gtest.h>

#include <random>

namespace realmodel {
namespace {

TEST(ParallelCounts, RunningTotalsAreThoseOfASimpleLoop) {
    std::mt19937 random(1);
    for (const std::size_t count : {0, 1, 65535, 65536, 65537, 300001}) {
        Array<std::uint32_t> counts(count + 1);
        std::vector<std::uint32_t> expected;
        std::uint32_t sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            counts[i] = random() % 5;
            expected.push_back(sum);
            sum += counts[i];
        }
        expected.push_back(sum);
        running_totals(counts, UINT32_MAX, {3, nullptr});
        EXPECT_EQ(std::vector<std::uint32_t>(counts.begin(), counts.end()), expected);
    }
}

TEST(ParallelCounts, TotalsThatAreTooLargeAreRefused) {
    Array<std::int32_t> counts(3);
    counts[0] = INT32_MAX;
    counts[1] = 1;
    try {
        running_totals(counts, INT32_MAX, {1, nullptr});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "too_large");
    }
}

TEST(ParallelCounts, EachItemIsCountedOnce) {
    constexpr std::size_t kItems = 100000;
    auto counters = zeros<std::uint32_t>(7, {3, nullptr});
    std::vector<std::uint32_t> number(kItems);
    parallel_ranges(kItems, 1000, {3, nullptr}, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            number[i] = atomic_increment(counters[i % 7]);
    });
    for (std::size_t group = 0; group < 7; ++group) {
        std::vector<std::uint8_t> taken(counters[group], 0);
        for (std::size_t i = group; i < kItems; i += 7)
            taken.at(number[i]) = 1;
        EXPECT_EQ(std::count(taken.begin(), taken.end(), 1), counters[group]);
        EXPECT_EQ(counters[group], (kItems - group + 6) / 7);
    }
}

TEST(ParallelCounts, WhatIsNumberedKeepsItsOrder) {
    constexpr std::size_t kItems = 100000;  // several ranges
    for (const int threads : {1, 3}) {
        std::vector<std::size_t> items;
        number_in_order(
            kItems, {threads, nullptr}, [](std::size_t item) { return item % 3 == 1; },
            [&](std::size_t count) { items.assign(count, 0); },
            [&](std::size_t item, std::size_t number) { items.at(number) = item; });
        ASSERT_EQ(items.size(), (kItems + 1) / 3);
        for (std::size_t number = 0; number < items.size(); ++number)
            ASSERT_EQ(items[number], 3 * number + 1);
    }
}

}  // namespace
}  // namespace realmodel
