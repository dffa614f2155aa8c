// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/arithmetic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

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

TEST(Int126, AgreesWithGmpOrIsNotKnown) {
    std::mt19937_64 random(1);
    int unknown = 0;
    for (int round = 0; round < 2000; ++round) {
        std::vector<Int126> shorts;
        std::vector<mpz_class> longs;
        for (int i = 0; i < 4; ++i) {
            const auto value = static_cast<std::int64_t>(random()) >> (2 + random() % 61);
            shorts.emplace_back(value);
            longs.push_back(mpz_class(std::to_string(value)));
        }
        for (int step = 0; step < 12; ++step) {
            const std::size_t i = random() % shorts.size(), j = random() % shorts.size();
            switch (random() % 4) {
                case 0:
                    shorts.push_back(shorts[i] + shorts[j]);
                    longs.emplace_back(longs[i] + longs[j]);
                    break;
                case 1:
                    shorts.push_back(shorts[i] - shorts[j]);
                    longs.emplace_back(longs[i] - longs[j]);
                    break;
                case 2:
                    shorts.push_back(-shorts[i]);
                    longs.emplace_back(-longs[i]);
                    break;
                default:
                    shorts.push_back(shorts[i] * shorts[j]);
                    longs.emplace_back(longs[i] * longs[j]);
            }
            if (!is_known(shorts.back())) {
                ++unknown;
                continue;
            }
            EXPECT_EQ(sign_of(shorts.back()), sgn(longs.back()));
            EXPECT_EQ(shorts.back().to_mpz(), longs.back());
        }
    }
    EXPECT_GT(unknown, 100);
    EXPECT_LT(unknown, 20000);
}

TEST(Int126, DifferencesAreWholeNumbersOfTheInputOrNotKnown) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(0.75, -3), b = g.add_vertex(1e6, 2.5),
                   far = g.add_vertex(1e30, 0);
    const SpaceId low = g.add_space_vertex(a, 0.125), high = g.add_space_vertex(b, 7);
    g.freeze_vertices();
    const Int126Arithmetic in(g);
    const IntegerArithmetic exact{g};
    EXPECT_EQ(in.dx(b, a).to_mpz(), exact.dx(b, a));
    EXPECT_EQ(in.dy(a, b).to_mpz(), exact.dy(a, b));
    EXPECT_EQ(in.dz(high, low).to_mpz(), exact.dz(high, low));
    EXPECT_EQ(in.plan(0.75).to_mpz(), exact.plan(0.75));
    EXPECT_EQ(in.height(7).to_mpz(), exact.height(7));
    EXPECT_FALSE(is_known(in.dx(far, a)));
}

TEST(Int126, NoAnswerFromShortOnesIsGivenByLongOnes) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(1e-30, 0), b = g.add_vertex(1e30, 1);
    g.freeze_vertices();
    int asked = 0;
    const int sign = exactly(g, [&](const auto& in, auto) -> std::optional<int> {
        ++asked;
        const auto d = in.dx(b, a);
        return is_known(d) ? std::optional(sign_of(d)) : std::nullopt;
    });
    EXPECT_EQ(sign, 1);
    EXPECT_GE(asked, 2);  // by each shorter type there is, and by GMP
}

}  // namespace
}  // namespace realmodel::exact
