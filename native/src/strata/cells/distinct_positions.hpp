// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/conform/conforming.hpp"

namespace realmodel::strata {

/// Distinct exact positions may round to one double. The structure is kept and such places get
/// neighbouring doubles: constructed places move (input vertices never do) by the least number of
/// units in the last place that makes them unlike all others, whole verticals at a time, so that
/// walls stay vertical. Plan vertices of a cell that all rounded to one x, or one y, are spread
/// likewise. (The heights on each vertical are different already, see conform_faces.)
void make_distinct(const exact::PlanArrangement& geometry, const FaceList& faces,
                   const PlanVertices& places, ConformedFaces& loops, int threads,
                   const Progress* progress);

}  // namespace realmodel::strata
