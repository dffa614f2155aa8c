// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/cells/built_cells.hpp"
#include "strata/repair/site.hpp"

namespace realmodel::strata {

/// The complex of all rock masses with a cell for each column.
/// @throws InputError kinds double_valued, base_not_below, rocks_overlap, too_large
BuiltCells build_columns(Site& site, const Execution& execution);

}  // namespace realmodel::strata
