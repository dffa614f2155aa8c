// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/column_fronts.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {

/// Where columns of one element may be given up, 1 or 0 for each triangle. Solvers call such
/// elements under-determined; but where the model is one element thick over a wide area, or
/// everywhere, giving them up at its border would only make their neighbors the border, until
/// nothing is left of them. So they may go where they form strips no wider than a few triangles
/// beside columns of more elements.
std::vector<std::uint8_t> narrow_strips(const PlanTopology& plan, const ColumnFronts& columns);

}  // namespace realmodel::simulation
