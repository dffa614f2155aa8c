// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel_sort.hpp"

#include <gtest/gtest.h>

#include <functional>
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

using Numbers = std::vector<double>;

Numbers sorted(const Numbers& numbers, double low, double high, const Execution& execution = {}) {
    const auto share = [=](double v) { return std::clamp((v - low) / (high - low), 0.0, 1.0); };
    constexpr std::size_t kChunks = 7;
    const auto produce = [&](std::size_t chunk, const auto& take) {
        for (std::size_t i = chunk; i < numbers.size(); i += kChunks)
            take(numbers[i]);
    };
    const auto result = BucketSort<double, decltype(share), std::less<>>(share, {}).sorted(
        kChunks, numbers.size(), produce, execution);
    return {result.begin(), result.end()};
}

void expect_sorted(Numbers numbers, double low = 0, double high = 1) {
    const Numbers one = sorted(numbers, low, high, {1}), three = sorted(numbers, low, high, {3});
    std::sort(numbers.begin(), numbers.end());
    EXPECT_EQ(one, numbers);
    EXPECT_EQ(three, numbers);
}

TEST(BucketSort, SortsAnyNumberOfElements) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(0, 1);
    for (const std::size_t count : {0, 1, 2, 15, 16, 17, 255, 256, 1000, 70001}) {
        Numbers numbers(count);
        for (double& v : numbers)
            v = number(random);
        expect_sorted(numbers);
    }
}

TEST(BucketSort, SortsWhatIsUnevenOrOutOfRange) {
    std::mt19937 random(2);
    std::normal_distribution<double> number(0.5, 1e-3);
    Numbers numbers(50000);
    for (double& v : numbers)
        v = number(random);
    for (std::size_t i = 0; i < numbers.size(); i += 10)
        numbers[i] = static_cast<double>(i % 30) * 10 - 100;
    expect_sorted(numbers);
}

TEST(BucketSort, SortsWhatIsAllInOneBucket) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(2, 3);
    Numbers numbers(300000);
    for (double& v : numbers)
        v = number(random);
    expect_sorted(numbers);
}

TEST(BucketSort, CanBeCancelled) {
    Progress progress;
    progress.cancel();
    EXPECT_THROW(sorted({1, 0}, 0, 1, {2, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel
