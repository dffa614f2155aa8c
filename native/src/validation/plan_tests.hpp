// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "validation/probes.hpp"

namespace realmodel::validation {

/// How often a closed loop winds round a place, counter-clockwise; exact. Loops that share an edge
/// agree about it, so that a vertical line meets the faces of closed cells in pairs.
int winding(std::span<const PlanPosition> loop, const PlanPosition& place);

/// Whether a segment passes within `reach` of a place (a little more may count).
bool passes(const PlanPosition& from, const PlanPosition& to, const PlanPosition& place,
            double reach);

}  // namespace realmodel::validation
