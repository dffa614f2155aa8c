// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/fixed_integer.hpp"

#include <gtest/gtest.h>

#include <random>

#include "exact/arithmetic.hpp"

namespace realmodel::exact {
namespace {

TEST(FixedInteger, GivesTheSignsOfGmp) {
    std::mt19937_64 random(1);
    const auto drawn = [&] {
        const double mantissa = std::ldexp(static_cast<double>(random() >> 11), -30);
        return std::ldexp(random() % 2 == 0 ? mantissa : -mantissa,
                          static_cast<int>(random() % 90));
    };
    for (int i = 0; i < 20000; ++i) {
        std::array<double, 6> numbers;
        int unit = 0;
        for (double& x : numbers) {
            x = i % 3 == 0 ? std::round(std::ldexp(drawn(), -90)) : drawn();
            unit = finest_exponent(x, unit);
        }
        // a tie, and what is one unit beside it
        const auto ask = [&](auto number) {
            using Number = decltype(number(0.0));  // GMP would hand on what is gone by then
            const auto [a, b, c, d, e, f] = numbers;
            const Number product = number(a) * number(b) * number(c) - number(d) * number(e);
            const Number tie = product * number(f) - number(f) * product;
            const Number near = tie + number(std::ldexp(1.0, unit)) - number(a) + number(a);
            return std::array{sign_of(product), sign_of(tie), sign_of(near),
                              sign_of(Number(product * product - number(f))),
                              sign_of(Number(-product + tie))};
        };
        EXPECT_EQ(ask([unit](double x) { return FixedInteger::of(x, unit); }),
                  ask([unit](double x) { return whole_number(x, unit); }));
    }
}

TEST(FixedInteger, CarriesAndBorrowsThroughAllLimbs) {
    const FixedInteger one = FixedInteger::of(1, 0), power = FixedInteger::of(0x1p320, 0);
    const FixedInteger ones = power - one;
    EXPECT_EQ(sign_of(ones + one - power), 0);
    EXPECT_EQ(sign_of(ones * ones - (power * power - power - power + one)), 0);
    EXPECT_EQ(sign_of(ones - power), -1);
}

TEST(FixedInteger, SaysWhereItIsTooNarrow) {
    const FixedInteger large = FixedInteger::of(0x1p1000, 0);
    EXPECT_TRUE(is_known(large));
    EXPECT_FALSE(is_known(large * large));
    EXPECT_FALSE(is_known(large * large - large * large));
    EXPECT_FALSE(is_known(FixedInteger::of(1.0, -1000) * FixedInteger::of(1.0, -1000)));
    EXPECT_FALSE(is_known(FixedInteger::of(0x1p1000, -1000)));
}

}  // namespace
}  // namespace realmodel::exact
