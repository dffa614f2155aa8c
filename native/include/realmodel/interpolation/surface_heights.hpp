// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// Heights of a triangulated surface at positions in plan, linear in each triangle; NaN where it
/// has none. On several triangles the first counts.
///
/// @param vertices   x, y, z
/// @param triangles  vertex numbers
/// @throws InputError kind "not_finite" (items: the vertex or node), "bad_index" (items: the
///         triangle)
/// @throws Cancelled
std::vector<double> heights_on_surface(std::span<const std::array<double, 3>> vertices,
                                       std::span<const std::array<std::int32_t, 3>> triangles,
                                       std::span<const std::array<double, 2>> nodes,
                                       const Execution& execution = {});

/// Where positions in plan lie on a triangulated surface. triangle: of each, -1 where there is
/// none; weights: of its second and third corner, of what these differ in height from the first
/// one.
struct PlacesOnSurface {
    std::vector<std::int32_t> triangle;
    std::vector<std::array<double, 2>> weights;
};

/// Where heights_on_surface finds the heights: surfaces that differ in these alone are looked at
/// once.
PlacesOnSurface places_on_surface(std::span<const std::array<double, 3>> vertices,
                                  std::span<const std::array<std::int32_t, 3>> triangles,
                                  std::span<const std::array<double, 2>> nodes,
                                  const Execution& execution = {});

}  // namespace realmodel::interpolation
