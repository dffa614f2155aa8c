// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/arithmetic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace realmodel::exact {
namespace {

constexpr double kLeast = std::numeric_limits<double>::denorm_min();

TEST(Arithmetic, FinestExponentIsThatOfTheLastBit) {
    EXPECT_EQ(finest_exponent(1.0, 100), 0);
    EXPECT_EQ(finest_exponent(-1.0, 100), 0);
    EXPECT_EQ(finest_exponent(12.0, 100), 2);
    EXPECT_EQ(finest_exponent(0.75, 100), -2);
    EXPECT_EQ(finest_exponent(0x1.0000000000001p0, 100), -52);
    EXPECT_EQ(finest_exponent(kLeast, 100), -1074);
    EXPECT_EQ(finest_exponent(-6 * kLeast, 100), -1073);
    EXPECT_EQ(finest_exponent(std::numeric_limits<double>::min(), 100), -1022);
    EXPECT_EQ(finest_exponent(std::numeric_limits<double>::max(), 1000), 971);
    EXPECT_EQ(finest_exponent(12.0, -5), -5);
    EXPECT_EQ(finest_exponent(0.0, 7), 7);
    EXPECT_EQ(finest_exponent(-0.0, 7), 7);
}

TEST(Arithmetic, WholeNumbersAreTheDoublesInUnitsOfTheFinest) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 10000; ++i) {
        const auto bits = static_cast<std::int64_t>(random() >> (11 + random() % 40));
        const double value = std::ldexp(static_cast<double>(random() % 2 == 0 ? bits : -bits),
                                        static_cast<int>(random() % 200) - 1074);
        const int unit = finest_exponent(value, 1000);
        const mpz_class whole = whole_number(value, unit);
        EXPECT_EQ(std::ldexp(whole.get_d(), unit), value);
        EXPECT_EQ(mpz_odd_p(whole.get_mpz_t()) != 0, value != 0);
    }
}

TEST(Arithmetic, WholeNumbersOf64BitsAreWhole) {
    EXPECT_EQ(whole_number_of(0), 0);
    EXPECT_EQ(whole_number_of(UINT64_MAX).get_str(), "18446744073709551615");
    EXPECT_EQ(whole_number_of(-(Int128{1} << 126)).get_str(),
              "-85070591730234615865843651857942052864");
    EXPECT_EQ(whole_number_of(std::uint64_t{1} << 32).get_str(), "4294967296");
    // more than 32 bits of mantissa, and a negative one
    EXPECT_EQ(whole_number(0x1.fffffffffffffp52, 0).get_str(), "9007199254740991");
    EXPECT_EQ(whole_number(-0x1.0000000000001p52, 0).get_str(), "-4503599627370497");
    EXPECT_EQ(whole_number(-0x1p40, 0).get_str(), "-1099511627776");
    EXPECT_EQ(whole_number(0, -1000), 0);
    EXPECT_EQ(whole_difference(1, -0x1p-60, -60).get_str(), "1152921504606846977");
    EXPECT_EQ(whole_difference(0, 0x1.fffffffffffffp72, 20),
              -whole_number(0x1.fffffffffffffp72, 20));  // just as wide as is short
    for (const int wide : {70, 73, 74, 75, 200}) {
        const double p = std::ldexp(0x1.fffffffffffffp52, wide), q = -std::ldexp(5.0, wide);
        EXPECT_EQ(whole_difference(p, q, 0), whole_number(p, 0) - whole_number(q, 0));
        EXPECT_EQ(whole_difference(q, p, 0), whole_number(q, 0) - whole_number(p, 0));
    }
}

TEST(Arithmetic, NearestDoubleTiesToEven) {
    const mpz_class one = 1, even = (one << 53), odd = even + 1;
    EXPECT_EQ(nearest_double(odd, 1, 0), 0x1p53);              // a tie: down to even
    EXPECT_EQ(nearest_double(even + 3, 1, 0), 0x1p53 + 4);     // a tie: up to even
    EXPECT_EQ(nearest_double(2 * odd + 1, 2, 0), 0x1p53 + 2);  // a half more than the tie
    EXPECT_EQ(nearest_double(-1, 3, 0), -1.0 / 3.0);
    EXPECT_EQ(nearest_double(5, -4, 3), -10.0);
    EXPECT_EQ(nearest_double(0, 7, 5), 0.0);
}

}  // namespace
}  // namespace realmodel::exact
