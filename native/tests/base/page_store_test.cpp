// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/page_store.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <span>
#include <thread>
#include <vector>

#include "../sanitized.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel {
namespace {

constexpr std::size_t kBlock = std::size_t{2} << 20;                // bytes
constexpr std::size_t kLarge = 5 * kBlock / sizeof(std::uint64_t);  // elements

/// Under AddressSanitizer nothing is kept.
void expect_kept(std::size_t blocks) {
    const bool keeps = page_store::kLargeArray < SIZE_MAX;
    EXPECT_EQ(page_store::kept(), keeps ? blocks * kBlock : 0);
}

std::uint64_t mixed(std::uint64_t i) {
    return i * 0x9E3779B97F4A7C15u;
}

template <class Array>
void fill(Array& array, std::uint64_t seed) {
    for (std::size_t i = 0; i < array.size(); ++i)
        array[i] = mixed(i + seed);
}
template <class Array>
bool is_filled(const Array& array, std::uint64_t seed) {
    for (std::size_t i = 0; i < array.size(); ++i) {
        if (array[i] != mixed(i + seed)) return false;
    }
    return true;
}

TEST(PageStore, KeepsBlocksOnlyWhileSomebodyAsksForIt) {
    { const Array<std::uint64_t> array(kLarge); }
    expect_kept(0);
    {
        const page_store::PageCache cache;
        {
            const page_store::PageCache second;
            const Array<std::uint64_t> array(kLarge);
        }
        expect_kept(5);
    }
    expect_kept(0);
}

TEST(PageStore, AnArrayTakesWhatIsNearestToItsSize) {
    const page_store::PageCache cache;
    Array<std::uint64_t> first(kLarge), between(kLarge), third(2 * kLarge);
    fill(between, 7);
    first = {};
    third = {};
    expect_kept(15);
    Array<std::uint64_t> part(kLarge / 5 * 4);
    expect_kept(10);
    Array<std::uint64_t> whole(2 * kLarge);
    expect_kept(0);
    fill(part, 1);
    fill(whole, 2);
    EXPECT_TRUE(is_filled(part, 1));
    EXPECT_TRUE(is_filled(whole, 2));
    part = {};
    whole = {};
    expect_kept(14);
    Array<std::uint64_t> wide(2 * kLarge + kLarge / 5);  // more than either
    expect_kept(4);
    fill(wide, 3);
    EXPECT_TRUE(is_filled(wide, 3));
    EXPECT_TRUE(is_filled(between, 7));
}

TEST(PageStore, NoMoreIsHeldThanArraysHadAtMost) {
    const page_store::PageCache cache;
    Array<std::uint64_t> first(kLarge), second(kLarge);
    first = {};
    expect_kept(5);
    second.resize(kLarge + kLarge / 5);
    expect_kept(0);  // one block of the other one is needed, and it is given back whole
}

TEST(PageStore, AnArrayKeepsItsContentsAsItGrows) {
    const page_store::PageCache cache;
    Array<std::uint64_t> array;
    for (std::size_t i = 0; i < 6 * kLarge; ++i) {
        array.push_back(mixed(i));
        if (i % kLarge == 0) const Array<std::uint64_t> dropped(kLarge);
    }
    EXPECT_TRUE(is_filled(array, 0));
    const Array<std::uint64_t> copy = array;
    array.resize(3);
    array.resize(kLarge, 1);
    EXPECT_EQ(array[2], mixed(2));
    EXPECT_EQ(array[kLarge - 1], 1u);
    EXPECT_TRUE(is_filled(copy, 0));
}

TEST(PageStore, ElementsOfOddSizesKeepTheirPlaces) {
    struct Odd {
        std::uint8_t bytes[7];
    };
    Array<Odd> array;
    for (std::size_t i = 0; i < 5 * kBlock / 7; ++i)
        array.push_back(
            {{static_cast<std::uint8_t>(i), 0, 0, 0, 0, 0, static_cast<std::uint8_t>(i >> 8U)}});
    for (std::size_t i = 0; i < array.size(); ++i) {
        ASSERT_EQ(array[i].bytes[0], static_cast<std::uint8_t>(i));
        ASSERT_EQ(array[i].bytes[6], static_cast<std::uint8_t>(i >> 8U));
    }
}

TEST(PageStore, WhatIsReservedCountsOnceItIsReady) {
    const page_store::PageCache cache;
    { const Array<std::uint64_t> dropped(kLarge); }
    {
        Array<std::uint64_t> array;
        array.reserve(3 * kLarge);  // of which five blocks come from the dropped one
        const auto* const there = array.data();
        expect_kept(0);
        array.make_ready(kLarge + kLarge / 5);
        array.data()[kLarge + kLarge / 5 - 1] = 17;  // set before it is counted
        array.resize(2 * kLarge);
        EXPECT_EQ(array.data(), there);
        EXPECT_EQ(array[kLarge + kLarge / 5 - 1], 17u);
    }
    expect_kept(10);
}

TEST(PageStore, ThreadsTakeAndDropAtOnce) {
    const page_store::PageCache cache;
    std::vector<std::thread> threads;
    std::vector<int> wrong(4);
    for (std::size_t t = 0; t < wrong.size(); ++t) {
        threads.emplace_back([t, &wrong] {
            for (std::uint64_t round = 0; round < (kSanitized ? 10 : 40); ++round) {
                Array<std::uint64_t> flat((2 + (round * (t + 3)) % 5) * kLarge / 5);
                fill(flat, round);
                Array<std::uint64_t> growing(kLarge / 5 * 2);
                fill(growing, t);
                growing.resize((3 + (round + t) % 4) * kLarge / 5);
                fill(growing, t);
                wrong[t] += is_filled(flat, round) && is_filled(growing, t) ? 0 : 1;
            }
        });
    }
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(std::accumulate(wrong.begin(), wrong.end(), 0), 0);
}

}  // namespace
}  // namespace realmodel
