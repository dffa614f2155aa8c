// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/double_double_interval.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <random>

#include "exact/arithmetic.hpp"

namespace realmodel::exact {
namespace {

double random_double(std::mt19937_64& random, int span) {
    std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
    std::uniform_int_distribution<int> exponent(-span, span);
    return std::ldexp(mantissa(random), exponent(random));
}

mpq_class value(const DoubleDoubleInterval& ball) {
    return mpq_class(ball.high) + mpq_class(ball.low);
}

void expect_within(const DoubleDoubleInterval& ball, const mpq_class& truth) {
    EXPECT_LE(abs(value(ball) - truth), mpq_class(ball.error));
}

TEST(DoubleDoubleInterval, HoldsTheTruthThroughRandomFormulas) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const double a = random_double(random, 30), b = random_double(random, 30);
        const double c = random_double(random, 30), d = random_double(random, 30);
        const mpq_class qa(a), qb(b), qc(c), qd(d);
        const DoubleDoubleInterval difference = DoubleDoubleInterval::difference(a, b);
        EXPECT_EQ(difference.error, 0.0);
        expect_within(difference, qa - qb);
        const DoubleDoubleInterval product = difference * DoubleDoubleInterval::difference(c, d);
        expect_within(product, (qa - qb) * (qc - qd));
        expect_within(product + DoubleDoubleInterval(a) * DoubleDoubleInterval(d),
                      (qa - qb) * (qc - qd) + qa * qd);
        expect_within(product / DoubleDoubleInterval(b), (qa - qb) * (qc - qd) / qb);
    }
}

TEST(DoubleDoubleInterval, RoundsAsExactArithmeticDoesOrDeclines) {
    std::mt19937_64 random(2);
    int declined = 0;
    for (int i = 0; i < 20000; ++i) {
        const double a = random_double(random, 10), b = random_double(random, 10);
        const double c = random_double(random, 10);
        const auto rounded =
            (DoubleDoubleInterval(a) * DoubleDoubleInterval(b) / DoubleDoubleInterval(c)).rounded();
        const mpq_class truth = mpq_class(a) * mpq_class(b) / mpq_class(c);
        if (!rounded) {
            ++declined;
            continue;
        }
        EXPECT_EQ(*rounded, nearest_double(truth.get_num(), truth.get_den(), 0));
    }
    EXPECT_LT(declined, 10);
}

TEST(DoubleDoubleInterval, KnowsExactZeroAndDeclinesNearZero) {
    EXPECT_EQ((DoubleDoubleInterval(3.0) * DoubleDoubleInterval::difference(2.0, 2.0)).rounded(),
              0.0);
    const DoubleDoubleInterval third = DoubleDoubleInterval(1.0) / DoubleDoubleInterval(3.0);
    EXPECT_FALSE(
        (third * DoubleDoubleInterval(3.0) - DoubleDoubleInterval(1.0)).sign().has_value());
    EXPECT_FALSE(
        (third * DoubleDoubleInterval(3.0) - DoubleDoubleInterval(1.0)).rounded().has_value());
}

TEST(DoubleDoubleInterval, DeclinesWhatOverflows) {
    const DoubleDoubleInterval huge(1e300);
    EXPECT_FALSE((huge * huge).rounded().has_value());
    EXPECT_FALSE((DoubleDoubleInterval(1.0) / DoubleDoubleInterval()).rounded().has_value());
}

TEST(NearestDouble, RoundsToNearestTiesToEven) {
    const mpz_class two53 = mpz_class(1) << 53;
    EXPECT_EQ(nearest_double(two53 + 1, 1, 0), 0x1p53);
    EXPECT_EQ(nearest_double(two53 + 3, 1, 0), 0x1p53 + 4);
    EXPECT_EQ(nearest_double((two53 + 1) * 1000 + 1, 1000, 0), 0x1p53 + 2);
    EXPECT_EQ(nearest_double(-1, 3, 0), -1.0 / 3.0);
    EXPECT_EQ(nearest_double(1, -3, 4), -16.0 / 3.0);
    EXPECT_EQ(nearest_double(0, 7, 3), 0.0);
}

TEST(NearestDouble, AgreesWithDivisionOfDoubles) {
    std::mt19937_64 random(3);
    std::uniform_int_distribution<std::int64_t> number(1, std::int64_t{1} << 52);
    for (int i = 0; i < 10000; ++i) {
        const auto a = static_cast<double>(number(random)), b = static_cast<double>(number(random));
        EXPECT_EQ(nearest_double(mpz_class(a), mpz_class(b), 0), a / b);
    }
}

TEST(WholeNumber, IsExactAtTheFinestExponent) {
    for (const double v : {0.0, 1.0, -0.75, 4.5e6 + 0x1p-20, 1e-6, -1e6, 0x1p-1070}) {
        const int unit = finest_exponent(v, 0);
        const mpz_class n = whole_number(v, unit);
        const mpq_class back = unit < 0 ? mpq_class(n, mpz_class(1) << static_cast<unsigned>(-unit))
                                        : mpq_class(n << static_cast<unsigned>(unit));
        mpq_class canonical = back;
        canonical.canonicalize();
        EXPECT_EQ(canonical, mpq_class(v));
    }
}

}  // namespace
}  // namespace realmodel::exact
