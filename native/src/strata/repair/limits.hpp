// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace realmodel::strata {

/// Beyond this the products behind floating-point filters overflow or vanish.
inline constexpr double kLargestCoordinate = 1e50;

/// Whether a coordinate of the input is a number within the limits.
inline bool is_within_limits(double coordinate) {
    return std::abs(coordinate) <= kLargestCoordinate;
}

}  // namespace realmodel::strata
