// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/array.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace realmodel {
namespace {

Array<std::int32_t> counted(std::size_t size) {
    Array<std::int32_t> array(size);
    std::iota(array.begin(), array.end(), 0);
    return array;
}

TEST(Array, KeepsItsElementsAsItGrows) {
    Array<std::array<double, 3>> array;
    for (int i = 0; i < 100000; ++i)
        array.push_back({1.0 * i, 2.0 * i, 3.0 * i});
    ASSERT_EQ(array.size(), 100000u);
    for (std::size_t i = 0; i < array.size(); ++i)
        ASSERT_EQ(array[i][2], 3.0 * static_cast<double>(i));
}

TEST(Array, TakesAnElementOfItsOwn) {
    Array<std::int32_t> array{7};
    while (array.size() < array.capacity())
        array.push_back(0);
    array.push_back(array.front());  // which moves them all
    EXPECT_EQ(array.back(), 7);
    array.resize(array.capacity() + 1, array.front());
    EXPECT_EQ(array.back(), 7);
}

TEST(Array, ResizingKeepsWhatWasThere) {
    auto array = counted(10);
    array.resize(4);
    EXPECT_EQ(array, counted(4));
    array.resize(6, -1);
    EXPECT_EQ(array, (Array<std::int32_t>{0, 1, 2, 3, -1, -1}));
    array.reserve(1000);
    EXPECT_EQ(array.size(), 6u);
    EXPECT_GE(array.capacity(), 1000u);
    array.assign(2, 5);
    EXPECT_EQ(array, (Array<std::int32_t>{5, 5}));
}

TEST(Array, CopiesAreApartAndMovedFromOnesEmpty) {
    auto array = counted(5);
    auto copy = array;
    copy[0] = 9;
    EXPECT_EQ(array[0], 0);
    copy = array;
    EXPECT_EQ(copy, array);
    const auto* const there = array.data();
    const Array<std::int32_t> moved = std::move(array);
    EXPECT_EQ(moved.data(), there);
    EXPECT_TRUE(array.empty());  // NOLINT(bugprone-use-after-move): what is left is told
    array.push_back(3);
    EXPECT_EQ(array.size(), 1u);
}

TEST(Array, IsARangeInOnePiece) {
    const auto array = counted(3);
    const std::span<const std::int32_t> seen = array;
    EXPECT_EQ(std::vector<std::int32_t>(seen.begin(), seen.end()),
              (std::vector<std::int32_t>{0, 1, 2}));
    Array<std::int32_t> more;
    more.append(seen.begin(), seen.end());
    more.append(seen.begin(), seen.end());
    EXPECT_EQ(more, (Array<std::int32_t>{0, 1, 2, 0, 1, 2}));
    EXPECT_TRUE(Array<std::int32_t>{} == Array<std::int32_t>(0));
}

}  // namespace
}  // namespace realmodel
