// SPDX-License-Identifier: GPL-3.0-or-later
// Where the segments of constraints meet others.
#pragma once

#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// For each segment the places at which it is to be cut, in order from its start: where it and
/// another cross (rounded, the same for both), and where another ends on it. Pairs of the first
/// `settled` segments are known to cross nowhere. Decisions are exact.
std::vector<std::vector<PlanPoint>> crossings(std::span<const PlanPoint> points,
                                              std::span<const Segment> segments,
                                              std::size_t settled, const Check& check);

}  // namespace realmodel::meshing
