// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/cells/cell_building.hpp"
#include "strata/repair/plan_context.hpp"

namespace realmodel::strata {

/// The complex of all rock masses with a cell for each column.
/// @throws InputError kinds double_valued, base_not_below, rocks_overlap, too_large
BuiltCells build_columns(PlanContext& context, const Execution& execution);

/// The complex of all rock masses with a cell for each connected component of a block.
/// @throws InputError kinds double_valued, base_not_below, rocks_overlap, too_large
BuiltCells build_blocks(PlanContext& context, const Execution& execution);

}  // namespace realmodel::strata
