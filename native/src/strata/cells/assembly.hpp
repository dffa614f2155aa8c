// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "realmodel/strata/stack.hpp"
#include "strata/conform/walls.hpp"

namespace realmodel::strata {

/// The complex (docs/dev/geometry.md) from finished faces, conformed faces and walls, which are
/// given back as they are used.
CellComplex assemble(const FaceList& faces, const std::vector<std::int32_t>& surface_of_plane,
                     ConformedFaces conformed, std::vector<WallBatch> walls,
                     Array<std::int32_t> cell_block, const Execution& execution);

/// Whether the faces of every cell use each of its edges as often in one direction as in the other.
bool are_closed(const CellComplex& complex);

}  // namespace realmodel::strata
