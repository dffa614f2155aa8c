// SPDX-License-Identifier: GPL-3.0-or-later
// exp(-x) of our own: the C library's takes another way on processors that multiply and add at
// once, and could give other bytes there. Private.
#pragma once

#include <bit>
#include <cstdint>

namespace realmodel::interpolation {

// Solutions of f(1) = 0.95, and a third as a factor.
inline constexpr double matern32_scale = 4.743864518390579;
inline constexpr double matern52_scale = 5.918649346310188;
inline constexpr double third = 1.0 / 3;

/// The constants of exp: x = n log 2 + r, exp(r) by its series up to r^13, within 2 units in the
/// last place. log 2 in two parts (fdlibm): n times the first is exact.
namespace exponential {
inline constexpr double largest = 700;  // exp(-700) is 1e-304: nothing beside a sill
inline constexpr double per_log2 = 1.4426950408889634;
inline constexpr double log2_high = 6.93147180369123816490e-01;
inline constexpr double log2_low = 1.90821492927058770002e-10;
inline constexpr double rounder = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds
inline constexpr int terms = 14;
inline constexpr double series[terms] = {1.0 / 6227020800.0,
                                         1.0 / 479001600.0,
                                         1.0 / 39916800.0,
                                         1.0 / 3628800.0,
                                         1.0 / 362880.0,
                                         1.0 / 40320.0,
                                         1.0 / 5040.0,
                                         1.0 / 720.0,
                                         1.0 / 120.0,
                                         1.0 / 24.0,
                                         1.0 / 6.0,
                                         0.5,
                                         1.0,
                                         1.0};
}  // namespace exponential

/// exp(-x), x >= 0.
inline double decay(double x) {
    namespace e = exponential;
    const double y = x < e::largest ? -x : -e::largest;
    const double shifted = y * e::per_log2 + e::rounder;
    const double n = shifted - e::rounder;
    const double r = (y - n * e::log2_high) - n * e::log2_low;
    double sum = e::series[0];
    for (int term = 1; term < e::terms; ++term)
        sum = sum * r + e::series[term];
    const auto scaled =
        std::bit_cast<std::uint64_t>(sum) + (std::bit_cast<std::uint64_t>(shifted) << 52);
    return std::bit_cast<double>(scaled);
}

}  // namespace realmodel::interpolation
