// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sort_doubles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace realmodel {
namespace {

TEST(SortDoubles, OrdersNumbersOfAllSizes) {
    std::mt19937_64 random(3);
    for (const std::size_t count : {0u, 1u, 100u, 5000u, 70000u}) {
        std::vector<double> values;
        for (std::size_t i = 0; i < count; ++i) {
            const double size = std::ldexp(1.0, static_cast<int>(random() % 600) - 300);
            values.push_back((random() % 2 == 0 ? -1 : 1) * size *
                             static_cast<double>(random() % 1000));
        }
        if (count > 2) values[1] = std::numeric_limits<double>::denorm_min();
        auto expected = values;
        std::sort(expected.begin(), expected.end());
        sort_doubles(values, nullptr);
        EXPECT_EQ(values, expected);
        for (const double value : values)
            EXPECT_FALSE(value == 0 && std::signbit(value));
    }
}

}  // namespace
}  // namespace realmodel
