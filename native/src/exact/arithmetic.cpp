// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/arithmetic.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace realmodel::exact {

namespace {

/// What GMP gets its memory by, once this library is loaded. By itself it ends the process where
/// there is none; an exception passes through it, and leaves the number that was to grow as it was.
/// What is freed may have been taken by GMP's own functions, which use the same memory.
void* grown(void* memory, std::size_t, std::size_t size) {
    void* const got = std::realloc(memory, size);
    if (got == nullptr) throw std::bad_alloc();
    return got;
}
void* taken(std::size_t size) {
    return grown(nullptr, 0, size);
}
[[maybe_unused]] const bool kGmpThrows = [] {
    mp_set_memory_functions(&taken, &grown, nullptr);
    return true;
}();

// A finite double as mantissa * 2^exponent with an odd mantissa; 0 for zero, whose exponent is left
// as it is.
std::int64_t odd_mantissa(double value, int& exponent) {
    assert(std::isfinite(value));
    const auto bits = std::bit_cast<std::uint64_t>(value);
    constexpr std::uint64_t kHidden = std::uint64_t{1} << 52;
    const int biased = static_cast<int>(bits >> 52) & 0x7ff;
    const std::uint64_t all = (bits & (kHidden - 1)) | (biased == 0 ? 0 : kHidden);
    if (all == 0) return 0;
    const int zeros = std::countr_zero(all);
    exponent = std::max(biased, 1) - 1075 + zeros;
    const auto mantissa = static_cast<std::int64_t>(all >> zeros);
    return std::signbit(value) ? -mantissa : mantissa;
}

}  // namespace

int finest_exponent(double value, int exponent) {
    int value_exponent = 0;
    return odd_mantissa(value, value_exponent) == 0 ? exponent : std::min(value_exponent, exponent);
}

mpz_class whole_number(double value, int exponent) {
    int value_exponent = exponent;
    mpz_class result = whole_number_of(Int128{odd_mantissa(value, value_exponent)});
    assert(value_exponent >= exponent);
    if (value_exponent > exponent) result <<= static_cast<unsigned>(value_exponent - exponent);
    return result;
}

mpz_class whole_difference(double p, double q, int exponent) {
    constexpr int kMaxShift = 126 - 53;  // so that neither has more than 126 bits
    int of_p = exponent, of_q = exponent;
    const Int128 from = odd_mantissa(p, of_p), to = odd_mantissa(q, of_q);
    assert(std::min(of_p, of_q) >= exponent);
    if (std::max(of_p, of_q) - exponent > kMaxShift)
        return whole_number(p, exponent) - whole_number(q, exponent);
    return whole_number_of((from << (of_p - exponent)) - (to << (of_q - exponent)));
}

double nearest_double(mpz_class num, mpz_class den, int exponent) {
    assert(sgn(den) != 0);
    if (sgn(num) == 0) return 0.0;
    const bool negative = (sgn(num) < 0) != (sgn(den) < 0);
    num = abs(num);
    den = abs(den);
    const auto bits = [](const mpz_class& n) {
        return static_cast<int>(mpz_sizeinbase(n.get_mpz_t(), 2));
    };
    // a quotient of at least 55 bits, with a last bit that says whether anything is left over
    const int shift = 56 - (bits(num) - bits(den));
    if (shift >= 0) {
        num <<= static_cast<unsigned>(shift);
    } else {
        den <<= static_cast<unsigned>(-shift);
    }
    mpz_class quotient, rest;
    mpz_tdiv_qr(quotient.get_mpz_t(), rest.get_mpz_t(), num.get_mpz_t(), den.get_mpz_t());
    const int drop = bits(quotient) - 53;
    assert(bits(quotient) <= 57);
    std::uint64_t whole = 0;
    mpz_export(&whole, nullptr, -1, sizeof whole, 0, 0, quotient.get_mpz_t());
    const std::uint64_t lost = whole & ((std::uint64_t{1} << drop) - 1);
    const std::uint64_t half = std::uint64_t{1} << (drop - 1);
    whole >>= drop;
    if (lost > half || (lost == half && (sgn(rest) != 0 || (whole & 1) != 0))) ++whole;
    const double size = std::ldexp(static_cast<double>(whole), exponent + drop - shift);
    return negative ? -size : size;
}

}  // namespace realmodel::exact
