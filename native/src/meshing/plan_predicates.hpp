// SPDX-License-Identifier: GPL-3.0-or-later
// Exact questions about points in plan. Private.
#pragma once

#include <string>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// Side of the line from a to b on which p lies: 1 left, -1 right, 0 on it. Exact.
int side_of_line(const PlanPoint& a, const PlanPoint& b, const PlanPoint& p);

/// Whether the open segments ab and cd meet in one point that ends neither of them. Exact.
bool cross_properly(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c, const PlanPoint& d);

/// Where the lines ab and cd meet, rounded; for messages.
PlanPoint crossing_place(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                         const PlanPoint& d);

/// "(x, y)" with as many digits as tell it from its neighbours on a map.
std::string text_of(const PlanPoint& place);

}  // namespace realmodel::meshing
