// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <optional>

#include "exact/orientation.hpp"

namespace realmodel::exact {

/// A number known to about 32 decimal digits: the unevaluated sum `high + low` of two doubles
/// (T. J. Dekker, "A floating-point technique for extending the available precision", 1971), with a
/// bound on how far the true value may be from it. Rounding a DoubleDoubleInterval either gives the
/// double nearest to the true value or says that it cannot tell. Overflow makes the bound NaN or
/// infinite, which reads as "cannot tell".
struct DoubleDoubleInterval {
    double high = 0.0;
    double low = 0.0;
    double error = 0.0;

    DoubleDoubleInterval() = default;
    DoubleDoubleInterval(double value) : high(value) {}  // NOLINT: an exact double
    DoubleDoubleInterval(double high_term, double low_term, double bound)
        : high(high_term), low(low_term), error(bound) {}

    /// The difference of two doubles, exactly.
    static DoubleDoubleInterval difference(double a, double b) {
        const double s = a - b;
        const double bb = s - a;
        return {s, (a - (s - bb)) - (b + bb), 0.0};
    }

    double magnitude() const { return std::abs(high) + error; }
    bool is_exact_zero() const { return high == 0.0 && low == 0.0 && error == 0.0; }

    /// The sign of the true value, or nothing where zero lies within the bound.
    std::optional<int> sign() const {
        if (is_exact_zero()) return 0;
        const double size = std::abs(high) * (1.0 - kNarrowing);
        if (size > error) return high > 0.0 ? 1 : -1;
        return std::nullopt;
    }

    /// The double nearest to the true value, or nothing where the bound leaves two to choose from.
    std::optional<double> rounded() const {
        const double slack = error * (kBoundSlack) + std::abs(low) * kNarrowing;
        const double up = high + (low + slack);
        const double down = high + (low - slack);
        if (up == down && std::isfinite(up)) return up;
        return std::nullopt;
    }

    friend DoubleDoubleInterval operator-(const DoubleDoubleInterval& a) {
        return {-a.high, -a.low, a.error};
    }
    friend DoubleDoubleInterval operator+(const DoubleDoubleInterval& a,
                                          const DoubleDoubleInterval& b) {
        const double s = a.high + b.high;
        const double bb = s - a.high;
        const double tail = ((a.high - (s - bb)) + (b.high - bb)) + (a.low + b.low);
        const double hi = s + tail;
        return {hi, tail - (hi - s),
                a.error + b.error + kDoubleDoubleUnit * (std::abs(a.high) + std::abs(b.high))};
    }
    friend DoubleDoubleInterval operator-(const DoubleDoubleInterval& a,
                                          const DoubleDoubleInterval& b) {
        return a + (-b);
    }
    friend DoubleDoubleInterval operator*(const DoubleDoubleInterval& a,
                                          const DoubleDoubleInterval& b) {
        if (a.is_exact_zero() || b.is_exact_zero()) return {};
        const double p = a.high * b.high;
        const double tail = product_tail(a.high, b.high, p) + (a.high * b.low + a.low * b.high);
        const double hi = p + tail;
        return {hi, tail - (hi - p),
                (std::abs(a.high) * b.error + std::abs(b.high) * a.error + a.error * b.error) *
                        (kBoundSlack) +
                    kDoubleDoubleUnit * std::abs(p) + kDoubleDoubleUnderflow};
    }
    friend DoubleDoubleInterval operator/(const DoubleDoubleInterval& a,
                                          const DoubleDoubleInterval& b) {
        if (a.is_exact_zero() && b.sign().value_or(0) != 0) return {};
        const double q = a.high / b.high;
        const DoubleDoubleInterval rest =
            DoubleDoubleInterval(a.high, a.low, 0.0) -
            DoubleDoubleInterval(q) * DoubleDoubleInterval(b.high, b.low, 0.0);
        const double correction = rest.high / b.high;
        const double hi = q + correction;
        const double divisor = std::abs(b.high) * (2.0 - kBoundSlack) - b.error;
        const double bound = divisor > 0.0
                                 ? ((a.error + std::abs(q) * b.error) / divisor) * (kBoundSlack) +
                                       kDoubleDoubleUnit * 8 * std::abs(q) + kDoubleDoubleUnderflow
                                 : HUGE_VAL;
        return {hi, correction - (hi - q), bound};
    }

private:
    /// a * b - p exactly, where p is the rounded product (Dekker 1971, without a fused operation so
    /// that every machine gives the same bits).
    static double product_tail(double a, double b, double p) {
        constexpr double kSplit = 134217729.0;  // 2^27 + 1
        const double ca = kSplit * a, cb = kSplit * b;
        const double ah = ca - (ca - a), bh = cb - (cb - b);
        const double al = a - ah, bl = b - bh;
        return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    }
};

}  // namespace realmodel::exact
