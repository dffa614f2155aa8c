// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/lists.hpp"

#include <gtest/gtest.h>

namespace realmodel {
namespace {

TEST(Lists, WhatIsFoundInEachKeepsItsOrder) {
    constexpr std::size_t kItems = 100000;  // several ranges
    for (const int threads : {1, 3}) {
        const auto found = found_in_each<std::size_t>(
            kItems, {threads, nullptr}, [](std::size_t item, std::vector<std::size_t>& own) {
                if (item % 3 == 1) own.insert(own.end(), {2 * item, 2 * item + 1});
            });
        ASSERT_EQ(found.size(), 2 * ((kItems + 1) / 3));
        for (std::size_t i = 0; i < found.size(); ++i)
            ASSERT_EQ(found[i], 2 * (3 * (i / 2) + 1) + i % 2);
    }
}

}  // namespace
}  // namespace realmodel
