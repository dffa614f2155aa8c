// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/host_device.hpp"

namespace realmodel::interpolation {

// Solutions of f(1) = 0.95, and a third as a factor.
inline constexpr double kMatern32Scale = 4.743864518390579;
inline constexpr double kMatern52Scale = 5.918649346310188;
inline constexpr double kThird = 1.0 / 3;

/// The constants of exp: x = n log 2 + r, exp(r) by its series up to r^13, within 2 units in the
/// last place. log 2 in two parts (fdlibm): n times the first is exact.
namespace exponential {
inline constexpr double kLargest = 700;  // exp(-700) is 1e-304: nothing beside a sill
inline constexpr double kPerLog2 = 1.4426950408889634;
inline constexpr double kLog2High = 6.93147180369123816490e-01;
inline constexpr double kLog2Low = 1.90821492927058770002e-10;
inline constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds
}  // namespace exponential

/// exp(-x), x >= 0, of a double or of a vector of doubles. Our own, because the C library's
/// computes differently on processors with fused multiply-add, and could give other bytes there.
/// @tparam Bits  the unsigned 64-bit number, or vector of them, with the bytes of a Number
template <class Bits = std::uint64_t, class Number>
REALMODEL_HOST_DEVICE inline Number decay(Number x) {
    namespace e = exponential;
    static_assert(sizeof(Bits) == sizeof(Number));
    // within the function: code of a GPU reads no array outside of it
    constexpr double kSeries[] = {1.0 / 6227020800.0,
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
    constexpr int kTerms = sizeof kSeries / sizeof *kSeries;
    const Number y = x < e::kLargest ? -x : Number{} - e::kLargest;
    const Number shifted = y * e::kPerLog2 + e::kRounder;
    const Number n = shifted - e::kRounder;
    const Number r = (y - n * e::kLog2High) - n * e::kLog2Low;
    Number sum = Number{} + kSeries[0];
    for (int term = 1; term < kTerms; ++term)
        sum = sum * r + kSeries[term];
    Bits bits, exponent;
    __builtin_memcpy(&bits, &sum, sizeof bits);
    __builtin_memcpy(&exponent, &shifted, sizeof exponent);
    bits += exponent << 52;
    __builtin_memcpy(&sum, &bits, sizeof bits);
    return sum;
}

/// cos(2 pi x) of a double or of a vector of doubles: 1 - 2 sin(pi x)^2, x less whole turns. Our
/// own for the reason that decay is. The series of the sine by odd powers up to x^21, within 2e-16
/// where |x| <= pi / 2; its signs and factorials, the last term first.
template <class Number>
REALMODEL_HOST_DEVICE inline Number cosine_of_turns(Number x) {
    constexpr double kSeries[] = {1.0 / 51090942171709440000.0,
                                  -1.0 / 121645100408832000.0,
                                  1.0 / 355687428096000.0,
                                  -1.0 / 1307674368000.0,
                                  1.0 / 6227020800.0,
                                  -1.0 / 39916800.0,
                                  1.0 / 362880.0,
                                  -1.0 / 5040.0,
                                  1.0 / 120.0,
                                  -1.0 / 6.0,
                                  1.0};
    constexpr int kTerms = sizeof kSeries / sizeof *kSeries;
    constexpr double kPi = 3.141592653589793;
    const Number turns = (x + exponential::kRounder) - exponential::kRounder;
    const Number half = kPi * (x - turns);
    const Number square = half * half;
    Number sum = Number{} + kSeries[0];
    for (int term = 1; term < kTerms; ++term)
        sum = sum * square + kSeries[term];
    sum *= half;
    return 1 - 2 * (sum * sum);
}

}  // namespace realmodel::interpolation
