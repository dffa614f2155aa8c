// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::strata {

/// The connected components of blocks: for each cell the least cell that it reaches through faces
/// between cells of its own block (itself, where there is none). Disjoint sets with path halving
/// (Tarjan and van Leeuwen 1984), the least member standing for each, so that the order of the
/// faces does not matter.
/// @param face_cells  the cells on both sides of each face, -1 outside
/// @param cell_block  the block of each cell
/// @throws InputError kind bad_index where a face refers to a cell that does not exist
/// @throws Cancelled
std::vector<std::int32_t> cell_components(std::span<const std::array<std::int32_t, 2>> face_cells,
                                          std::span<const std::int32_t> cell_block,
                                          Progress* progress = nullptr);

/// The sides of each cell: the faces that bound it, and whether it lies on their far side.
struct CellFaces {
    Array<std::uint32_t> offsets;  ///< sides of cell c: offsets[c] .. offsets[c + 1] - 1
    Array<std::uint32_t> faces;    ///< 2 face + 1 where the cell is the face's second one
};
/// Sorts the sides of faces by cell, in the order of the faces, on all threads.
/// @throws InputError kinds bad_index where a face refers to a cell that does not exist, too_large
/// @throws Cancelled
CellFaces faces_of_cells(std::span<const std::array<std::int32_t, 2>> face_cells, std::size_t cells,
                         Progress* progress = nullptr);

}  // namespace realmodel::strata
