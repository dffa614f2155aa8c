// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/column_heights.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {

/// What the model has at each post. A post beside a step or at the border takes the heights nearest
/// to its node that are on its own side of the steps of the model: lines were simplified, so the
/// node itself may lie beyond one. Of a post without any its rock is -1.
ColumnHeights post_columns(const ComplexView& model, const RockBlocks& blocks,
                           const PlanLines& lines, const PlanTopology& plan,
                           const Execution& execution);

}  // namespace realmodel::simulation
