// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "strata/cells/exact_positions.hpp"
#include "strata/conform/conformed_faces.hpp"

namespace realmodel::strata {

/// A cell whose plan vertices all have one x, or one y.
struct FlatCell {
    std::int32_t cell;
    PlanPosition at;  ///< its lowest x and y
};

/// Distinct exact positions may round to one double. The structure is kept and such positions
/// become neighboring doubles: constructed ones move (input vertices never do) by the least number
/// of units in the last place that makes them unlike all others, whole verticals at a time, so that
/// walls stay vertical. Plan vertices of a cell that all rounded to one x, or one y, are spread
/// likewise. (The heights on each vertical are different already, see conform_faces.) What is on
/// the border of a tile stays on it, and what only rounded to it moves inside.
/// @param border  nothing unless this is a tile
/// @return the cells that are flat still, after some rounds or because nothing of them may move
std::vector<FlatCell> make_distinct(const exact::PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& plan_vertices, ConformedFaces& conformed,
                                    const TileBorder* border, const Execution& execution);

}  // namespace realmodel::strata
