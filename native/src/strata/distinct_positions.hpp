// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "conforming.hpp"

namespace realmodel::strata {

/// Distinct exact positions may round to one double. The structure is kept and such positions get
/// neighbouring doubles: constructed places move (input vertices never do) by the least number of
/// units in the last place that makes them unlike all others, whole verticals at a time, so that
/// walls stay vertical; then the heights on each vertical are spread upward in their order. Places
/// of a cell that all rounded to one x, or one y, are spread likewise.
void make_distinct(const exact::PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   Loops& loops, const Progress* progress);

}  // namespace realmodel::strata
