// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/key_table.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

namespace realmodel {
namespace {

TEST(KeyTable, NumbersKeysInOrderOfFirstInsertion) {
    KeyTable table;
    std::vector<KeyTable::Key> keys;
    const auto insert = [&](const KeyTable::Key& key) {
        const auto found = table.insert(
            key, [&](std::int32_t known) { return keys[static_cast<std::size_t>(known)]; });
        if (found.is_new) keys.push_back(key);
        return found;
    };
    std::map<KeyTable::Key, std::int32_t> reference;
    std::mt19937 random(1);
    std::uniform_int_distribution<std::int32_t> number(-20, 20);
    for (int i = 0; i < 20000; ++i) {
        const KeyTable::Key key{number(random), number(random), number(random), 0};
        const auto next = static_cast<std::int32_t>(reference.size());
        const auto [at, is_new] = reference.emplace(key, next);
        const auto found = insert(key);
        EXPECT_EQ(found.number, at->second);
        EXPECT_EQ(found.is_new, is_new);
    }
    for (const auto& [key, n] : reference)
        EXPECT_EQ(insert(key).number, n);
    EXPECT_EQ(table.size(), static_cast<std::int32_t>(reference.size()));
}

TEST(KeyTable, FindsWhatWasAddedThoughHashesAreEqual) {
    KeyTable table;
    const auto add = [&](int value) {
        return table.find_or_add(static_cast<std::uint32_t>(value % 7), value,
                                 [&](std::int32_t number) { return number == value; });
    };
    for (int i = 0; i < 1000; ++i)
        EXPECT_TRUE(add(i).is_new);
    for (int i = 0; i < 1000; ++i) {
        EXPECT_FALSE(add(i).is_new);
        EXPECT_EQ(add(i).number, i);
    }
}

TEST(KeyTable, LookingUpAddsNothing) {
    KeyTable table;
    const auto find = [&](int value) {
        return table.find(static_cast<std::uint32_t>(value % 7),
                          [&](std::int32_t number) { return number == value; });
    };
    EXPECT_EQ(find(3), -1);
    for (int i = 0; i < 100; i += 2)
        table.find_or_add(static_cast<std::uint32_t>(i % 7), i, [](std::int32_t) { return false; });
    for (int i = 0; i < 100; ++i)
        EXPECT_EQ(find(i), i % 2 == 0 ? i : -1);
    EXPECT_EQ(table.size(), 50);
}

}  // namespace
}  // namespace realmodel
