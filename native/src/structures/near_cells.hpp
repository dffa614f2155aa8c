// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cutting/nearest_side.hpp"
#include "structures/structure_surface.hpp"

namespace realmodel::structures {

/// Of a cell of a model: that it comes near a structure and is not on the wrong side of another,
/// that it comes near none and is on the sides that are asked for, or that it is elsewhere.
enum class CellPlace : std::uint8_t { kElsewhere, kInside, kNear };

/// @param structures  of each where its sides are
/// @param given       the same structures
std::vector<CellPlace> places_of_cells(const ComplexView& model, const Sides& sides,
                                       std::span<const cutting::NearestSide> structures,
                                       std::span<const Structure> given,
                                       const Execution& execution);

}  // namespace realmodel::structures
