// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/page_store.hpp"

#include <gtest/gtest.h>

#if defined(__linux__)
#include <sys/mman.h>
#include <unistd.h>
#endif

#include <cstdint>
#include <numeric>
#include <span>
#include <thread>
#include <vector>

#include "realmodel/base/array.hpp"

namespace realmodel {
namespace {

using page_store::kBlock;

constexpr std::size_t kLarge = 5 * kBlock / sizeof(std::uint64_t);  // elements

/// Under AddressSanitizer, and on other systems than Linux and Windows, arrays come from malloc:
/// they behave the same, and nothing is kept. Windows keeps up to a quarter of what was used more.
void expect_kept(std::size_t blocks) {
    const std::size_t bytes = page_store::kIsThere ? blocks * kBlock : 0;
#if defined(_WIN64)
    EXPECT_GE(page_store::kept(), bytes);
    EXPECT_LE(page_store::kept(), bytes + 4 * kBlock);
#else
    EXPECT_EQ(page_store::kept(), bytes);
#endif
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
        const page_store::Keeper keeper;
        {
            const page_store::Keeper another;
            const Array<std::uint64_t> array(kLarge);
        }
        expect_kept(5);
    }
    expect_kept(0);
}

TEST(PageStore, AnArrayTakesTheBlocksOfOthers) {
    const page_store::Keeper keeper;
    Array<std::uint64_t> first(kLarge), between(kLarge), third(kLarge);
    fill(between, 7);
    first = {};
    third = {};
    expect_kept(10);
    Array<std::uint64_t> wide(2 * kLarge + kLarge / 5);  // more than either, and than both
    expect_kept(0);
    fill(wide, 3);
    EXPECT_TRUE(is_filled(between, 7));
    EXPECT_TRUE(is_filled(wide, 3));
    wide = {};
    expect_kept(11);
    Array<std::uint64_t> part(kLarge / 5 * 4);
    expect_kept(7);
    fill(part, 1);
    EXPECT_TRUE(is_filled(part, 1));
    EXPECT_TRUE(is_filled(between, 7));
}

TEST(PageStore, AArrayMovesWithItsBlocks) {
    const page_store::Keeper keeper;
    Array<std::uint64_t> array;
    for (std::size_t i = 0; i < 6 * kLarge; ++i) {
        array.push_back(mixed(i));
        if (i % kLarge == 0) const Array<std::uint64_t> dropped(kLarge);  // whose blocks it takes
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

TEST(PageStore, WhatIsReservedTakesNoBlocksBeforeItIsReady) {
    const page_store::Keeper keeper;
    { const Array<std::uint64_t> dropped(kLarge); }
    Array<std::uint64_t> array;
    array.reserve(kLarge);
    const auto* const there = array.data();
    expect_kept(5);
    array.make_ready(kLarge / 5);
    expect_kept(4);
    array.data()[kLarge / 5 - 1] = 17;  // set before it is counted
    array.make_ready(kLarge);
    expect_kept(0);
    array.resize(kLarge);
    EXPECT_EQ(array.data(), there);
    EXPECT_EQ(array[kLarge / 5 - 1], 17u);
}

#if defined(__linux__)
/// Moving a block fails where there are no pages: as where the system is short of memory, which a
/// test cannot bring about.
void lose_pages(const void* begin, std::size_t bytes) {
    ASSERT_EQ(munmap(const_cast<void*>(begin), bytes), 0);
}

TEST(PageStore, AnArrayWhoseKeptBlocksCannotBeMovedIsCopiedToFreshPages) {
    if (!page_store::kIsThere) GTEST_SKIP() << "arrays are malloc's here";
    const page_store::Keeper keeper;
    Array<std::uint64_t> growing(kLarge);
    growing.reserve(3 * kLarge);
    fill(growing, 5);
    const auto* const there = growing.data();
    {
        Array<std::uint64_t> dropped(kLarge);
        lose_pages(dropped.data(), kBlock);  // the last that will be taken
    }
    expect_kept(5);
    growing.resize(3 * kLarge);
    EXPECT_NE(growing.data(), there);
    expect_kept(0);
    growing.resize(kLarge);
    EXPECT_TRUE(is_filled(growing, 5));
    growing.resize(3 * kLarge);
    fill(growing, 6);
    EXPECT_TRUE(is_filled(growing, 6));
}

TEST(PageStore, AnArrayThatCannotBeMovedIsCopied) {
    if (!page_store::kIsThere) GTEST_SKIP() << "arrays are malloc's here";
    Array<std::uint64_t> array(kLarge);
    fill(array, 5);
    const auto* const there = array.data();
    constexpr long kSeal = 462;  // system call mseal: what is sealed can neither move nor go
    const char* const third = reinterpret_cast<const char*>(there) + 2 * kBlock;
    if (syscall(kSeal, third, kBlock, 0UL) != 0) GTEST_SKIP() << "mseal needs Linux 6.10";
    array.reserve(3 * kLarge);
    EXPECT_NE(array.data(), there);
    array.resize(2 * kLarge);
    array.resize(kLarge);
    EXPECT_TRUE(is_filled(array, 5));
}
#endif

TEST(PageStore, ThreadsTakeAndDropAtOnce) {
    const page_store::Keeper keeper;
    std::vector<std::thread> threads;
    std::vector<int> wrong(4);
    for (std::size_t t = 0; t < wrong.size(); ++t) {
        threads.emplace_back([t, &wrong] {
            for (std::uint64_t round = 0; round < 40; ++round) {
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
