// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

/// Beyond this the products behind floating-point filters overflow or vanish.
inline constexpr double kLargestCoordinate = 1e50;

/// Whether a coordinate of the input is a number within the limits.
inline bool is_within_limits(double coordinate) {
    return std::abs(coordinate) <= kLargestCoordinate;
}

/// Half-edges of a mesh are 32-bit numbers.
/// @throws InputError kind too_large
inline void check_triangle_count(std::size_t triangles) {
    if (triangles > UINT32_MAX / 3) {
        throw InputError("too_large",
                         "a surface has more than 1431 million triangles; use a coarser one");
    }
}

}  // namespace realmodel::strata
