// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace realmodel {

/// The unit in the last place of a number: from its size to the next larger double.
inline double ulp(double x) {
    const double size = std::abs(x);
    return std::nextafter(size, HUGE_VAL) - size;
}

/// Half a unit is the rounding of a number. Coordinates that people compute with are themselves off
/// by one or two: what is within so many units of something may be meant to lie on it.
inline constexpr double kComputedUlps = 4;

/// The double that is so many doubles above the value, or below it where `steps` is negative.
inline double moved_by_ulps(double value, int steps) {
    for (; steps > 0; --steps)
        value = std::nextafter(value, HUGE_VAL);
    for (; steps < 0; ++steps)
        value = std::nextafter(value, -HUGE_VAL);
    return value;
}

/// Sum with a running correction (Knuth's exact sum of two doubles, added up).
struct CorrectedSum {
    double total = 0, correction = 0;
    void add(double value) {
        const double next = total + value;
        const double added = next - total;
        correction += (total - (next - added)) + (value - added);
        total = next;
    }
    double value() const { return total + correction; }
};

}  // namespace realmodel
