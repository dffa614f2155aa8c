// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// How far a cross product of two steps may be off where each corner is by `rounding`.
inline double slack(const PlanePosition& a, const PlanePosition& b, const PlanePosition& c,
                    const PlanePosition& rounding) {
    return rounding[0] * (std::abs(b[1] - a[1]) + std::abs(c[1] - b[1])) +
           rounding[1] * (std::abs(b[0] - a[0]) + std::abs(c[0] - b[0]));
}

}  // namespace realmodel::cutting
