// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/algorithms.hpp"

#include <gtest/gtest.h>

namespace realmodel {
namespace {

TEST(Algorithms, WhatIsFoundInEachKeepsItsOrder) {
    constexpr std::size_t kItems = 100000;  // several ranges
    for (const int threads : {1, 3}) {
        const auto found = collect_items<std::size_t>(
            kItems, {threads, nullptr}, [](std::size_t item, std::vector<std::size_t>& own) {
                if (item % 3 == 1) own.insert(own.end(), {2 * item, 2 * item + 1});
            });
        ASSERT_EQ(found.size(), 2 * ((kItems + 1) / 3));
        for (std::size_t i = 0; i < found.size(); ++i)
            ASSERT_EQ(found[i], 2 * (3 * (i / 2) + 1) + i % 2);
    }
}

TEST(Algorithms, GroupsAreRunsOfEqualKeys) {
    std::vector<std::pair<int, char>> items{{1, 'a'}, {1, 'b'}, {2, 'c'}, {1, 'd'}};
    std::vector<std::size_t> sizes;
    for (const auto group : groups_of(items, &std::pair<int, char>::first)) {
        sizes.push_back(group.size());
        group[0].second = 'x';
    }
    EXPECT_EQ(sizes, (std::vector<std::size_t>{2, 1, 1}));
    EXPECT_EQ(items[2].second, 'x');
    items.clear();
    for (const auto group : groups_of(items))
        FAIL() << group.size();
}

TEST(Algorithms, ItemsWithAKeyAreASpan) {
    const std::vector<std::pair<int, char>> sorted{{1, 'a'}, {2, 'b'}, {2, 'c'}, {4, 'd'}};
    const auto two = items_with_key(sorted, 2, &std::pair<int, char>::first);
    ASSERT_EQ(two.size(), 2u);
    EXPECT_EQ(two[1].second, 'c');
    EXPECT_TRUE(items_with_key(sorted, 3, &std::pair<int, char>::first).empty());
}

TEST(Algorithms, KeepSingleDropsWhatOccursTwice) {
    std::vector<int> sorted{1, 1, 2, 3, 3, 3, 4};
    keep_single(sorted);
    EXPECT_EQ(sorted, (std::vector<int>{2, 4}));
    std::vector<int> unsorted{3, 1, 3, 2};
    sort_unique(unsorted);
    EXPECT_EQ(unsorted, (std::vector<int>{1, 2, 3}));
}

}  // namespace
}  // namespace realmodel
