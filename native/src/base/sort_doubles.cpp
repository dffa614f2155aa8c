// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sort_doubles.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace realmodel {

namespace {

constexpr int kDigitBits = 11, kDigits = 6;
constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
constexpr std::uint64_t kSign = std::uint64_t{1} << 63;

/// Bits whose order as a whole number is that of the doubles.
std::uint64_t ordered_bits(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

double value_of(std::uint64_t ordered) {
    return std::bit_cast<double>((ordered & kSign) != 0 ? ordered & ~kSign : ~ordered);
}

std::size_t digit_of(std::uint64_t key, int digit) {
    return static_cast<std::size_t>(key >> (digit * kDigitBits)) & (kBuckets - 1);
}

}  // namespace

void sort_doubles(std::vector<double>& values, const Progress* progress) {
    constexpr std::size_t kFew = 1 << 12;
    if (values.size() < kFew) {
        for (double& value : values)
            value += 0.0;
        std::sort(values.begin(), values.end());
        return;
    }
    std::vector<std::uint64_t> keys(values.size()), next(values.size());
    std::vector<std::array<std::size_t, kBuckets>> counts(kDigits);
    for (auto& of_digit : counts)
        of_digit.fill(0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        keys[i] = ordered_bits(values[i]);
        for (int digit = 0; digit < kDigits; ++digit)
            ++counts[static_cast<std::size_t>(digit)][digit_of(keys[i], digit)];
    }
    for (int digit = 0; digit < kDigits; ++digit) {
        if (progress != nullptr) progress->check();
        auto& count = counts[static_cast<std::size_t>(digit)];
        if (count[digit_of(keys.front(), digit)] == keys.size()) continue;  // all alike
        std::size_t total = 0;
        for (std::size_t& bucket : count) {
            const std::size_t own = bucket;
            bucket = total;
            total += own;
        }
        for (const std::uint64_t key : keys)
            next[count[digit_of(key, digit)]++] = key;
        keys.swap(next);
    }
    std::transform(keys.begin(), keys.end(), values.begin(), value_of);
}

}  // namespace realmodel
