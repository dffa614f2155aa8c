// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "simulation/cleaning/editable_complex.hpp"

namespace realmodel::simulation {
namespace {

std::vector<std::int32_t> list(const ListPool& pool, std::int32_t number) {
    return {pool[number].begin(), pool[number].end()};
}

TEST(ListPool, AListThatGrowsLeavesTheOthersAlone) {
    const std::vector<std::int64_t> offsets{0, 2, 2, 5};
    ListPool pool(std::span<const std::int64_t>(offsets), {4, 5, 6, 7, 8});
    ASSERT_EQ(pool.size(), 3U);
    for (std::int32_t k = 0; k < 10; ++k)
        pool.push(0, 10 + k);
    pool.push(1, 1);
    EXPECT_EQ(list(pool, 0),
              (std::vector<std::int32_t>{4, 5, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19}));
    EXPECT_EQ(list(pool, 1), (std::vector<std::int32_t>{1}));
    EXPECT_EQ(list(pool, 2), (std::vector<std::int32_t>{6, 7, 8}));
}

TEST(ListPool, NumbersAreTakenOutAndReplacedInOrder) {
    const std::vector<std::int64_t> offsets{0, 3};
    ListPool pool(std::span<const std::int64_t>(offsets), {6, 7, 8});
    pool.erase(0, 7);
    EXPECT_EQ(list(pool, 0), (std::vector<std::int32_t>{6, 8}));
    EXPECT_EQ(pool.add_list(), 1);
    EXPECT_TRUE(pool[1].empty());
    pool.set(0, std::vector<std::int32_t>{1, 2, 3, 4});  // longer than ever
    pool.set(1, std::vector<std::int32_t>{9});
    EXPECT_EQ(list(pool, 0), (std::vector<std::int32_t>{1, 2, 3, 4}));
    EXPECT_EQ(list(pool, 1), (std::vector<std::int32_t>{9}));
}

}  // namespace
}  // namespace realmodel::simulation
