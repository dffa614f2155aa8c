// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "conforming.hpp"

namespace realmodel::strata {

/// Distinct exact positions may round to one double. The structure is kept and such places get
/// neighbouring doubles: constructed places move (input vertices never do) by the least number of
/// units in the last place that makes them unlike all others, whole verticals at a time, so that
/// walls stay vertical. Places of a cell that all rounded to one x, or one y, are spread likewise.
/// (The heights on each vertical are different already, see find_loops.)
void make_distinct(const exact::PlanGeometry& geometry, const FaceList& faces, const Places& places,
                   Loops& loops, int threads, const Progress* progress);

}  // namespace realmodel::strata
