// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash_index.hpp"

#include <gtest/gtest.h>

#include <array>

namespace realmodel {
namespace {

TEST(HashIndex, FindsWhatWasInsertedThoughHashesAreEqual) {
    HashIndex table;
    std::vector<int> values;
    for (int i = 0; i < 1000; ++i) {
        values.push_back(i);
        table.insert(static_cast<std::uint64_t>(i % 7), i);
    }
    for (int i = 0; i < 1000; ++i) {
        const auto is_it = [&](std::int32_t n) { return values[static_cast<std::size_t>(n)] == i; };
        EXPECT_EQ(table.find(static_cast<std::uint64_t>(i % 7), is_it), i);
    }
    EXPECT_EQ(table.find(3, [](std::int32_t) { return false; }), -1);
}

TEST(HashIndex, AnEmptyTableHasNothing) {
    EXPECT_EQ(
        HashIndex().find(HashIndex::hash(std::array{1, 2}), [](std::int32_t) { return true; }), -1);
}

}  // namespace
}  // namespace realmodel
