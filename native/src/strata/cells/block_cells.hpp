// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/strata/stack.hpp"
#include "strata/overlay/block_overlay.hpp"

namespace realmodel::strata {

/// The complex of what the overlay left: nodes that hang together become one cell, faces that are
/// parts of triangles get the vertices on their edges and the walls between them, and whole
/// triangles that nothing touches are taken as they are. surface_of_plane and first_block turn
/// planes and blocks of the rock mass into numbers of the model.
CellComplex assemble_blocks(exact::PlanArrangement& geometry, BlockOverlay& overlay,
                            const std::vector<std::int32_t>& surface_of_plane,
                            std::optional<PlaneId> base, std::int32_t first_block, int threads,
                            const Progress* progress);

}  // namespace realmodel::strata
