// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel_sort.hpp"

#include <gtest/gtest.h>

#include <random>

#include "../sanitized.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel {
namespace {

TEST(ParallelSort, SortsAnyNumberOfElements) {
    std::mt19937 random(1);
    for (const std::size_t count :
         {0, 1, 2, 65535, 65536, 65537, 131072, kSanitized ? 140001 : 700001}) {
        for (const int largest : {3, 1000000000}) {
            std::uniform_int_distribution<int> number(0, largest);
            std::vector<int> values(count);
            for (int& v : values)
                v = number(random);
            auto expected = values;
            std::sort(expected.begin(), expected.end());
            parallel_sort(values, std::less<>(), {3, nullptr});
            EXPECT_EQ(values, expected);
        }
    }
}

TEST(ParallelSort, CanBeCancelled) {
    Progress progress;
    progress.cancel();
    std::vector<int> values(10, 1);
    EXPECT_THROW(parallel_sort(values, std::less<>(), {2, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel
