// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "strata/repair/plan_snapping.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Whether three points of space lie in one line.
bool in_one_line(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c);

/// Checks surfaces, enters their vertices and links their triangles; leaves out triangles without
/// area (with a warning). The first of them is number `first_index` of all.
/// @throws InputError kinds not_finite, bad_index, vertical_triangle
std::vector<EnteredSurface> enter_surfaces(exact::PlanArrangement& geometry,
                                           std::span<const TriangleView> surfaces, int first_index,
                                           const PlanSnapping& snapping,
                                           std::vector<Warning>& warnings,
                                           const Execution& execution);

}  // namespace realmodel::strata
