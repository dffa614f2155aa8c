// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/grouped_items.hpp"

#include <gtest/gtest.h>

#include <string>

namespace realmodel {
namespace {

TEST(GroupedItems, KeepTheOrderWithinEachGroup) {
    const std::vector<std::string> words{"be", "a", "dog", "cat", "of", "ox"};
    const auto by_length = grouped<std::string>(5, [&](const auto& visit) {
        for (const std::string& word : words)
            visit(word.size(), word);
    });
    EXPECT_EQ(by_length.first, (std::vector<std::size_t>{0, 0, 1, 4, 6, 6}));
    EXPECT_EQ(by_length.items, (std::vector<std::string>{"a", "be", "of", "ox", "dog", "cat"}));
    EXPECT_TRUE(by_length[0].empty());
    EXPECT_EQ(by_length[3].back(), "cat");
}

TEST(GroupedItems, OfNothing) {
    const auto none = grouped<int>(0, [](const auto&) {});
    EXPECT_EQ(none.first, std::vector<std::size_t>{0});
    EXPECT_TRUE(none.items.empty());
}

}  // namespace
}  // namespace realmodel
