// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace realmodel {

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
