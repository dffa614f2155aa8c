// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace realmodel::interpolation {

/// The range of finite heights.
struct DataRange {
    double low = HUGE_VAL, high = -HUGE_VAL;

    void add(double z) {
        if (!std::isfinite(z)) return;
        low = std::min(low, z);
        high = std::max(high, z);
    }
    double size() const { return high - low; }
};

}  // namespace realmodel::interpolation
