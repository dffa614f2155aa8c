// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/progress.hpp"

namespace realmodel::strata {

/// The connected parts of blocks: for each cell the least cell that it reaches through faces
/// between cells of its own block (itself, where there is none). Disjoint sets with path halving
/// (Tarjan and van Leeuwen 1984), the least member standing for each, so that the order of the
/// faces does not matter.
/// @param face_cells  the cells on both sides of each face, -1 outside
/// @param cell_block  the block of each cell
/// @throws InputError kind bad_index where a face names a cell that is not there
/// @throws Cancelled
std::vector<std::int32_t> cell_components(std::span<const std::array<std::int32_t, 2>> face_cells,
                                          std::span<const std::int32_t> cell_block,
                                          const Progress* progress = nullptr);

}  // namespace realmodel::strata
