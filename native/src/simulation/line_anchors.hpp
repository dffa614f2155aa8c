// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "simulation/traces.hpp"

namespace realmodel::simulation {

/// Points on the traces, apart by `spacing` there (along steps and walls by 0.7 of it at least), so
/// that every position on the traces has one as near. Corners of steps and walls come first, then
/// points spread evenly along these, so close that no other line can draw them aside; then the ends
/// of other lines, and points between them.
std::vector<PlanPoint> line_anchors(const Traces& traces,
                                    const std::function<double(const PlanPoint&)>& spacing,
                                    Progress* progress);

}  // namespace realmodel::simulation
