// SPDX-License-Identifier: GPL-3.0-or-later
/// Cells and faces in the order in which files of polyhedra want them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "realmodel/base/array.hpp"

namespace realmodel::simulation {

/// Polygons one after another: face f is vertices[offsets[f] .. offsets[f + 1]].
struct FaceLoops {
    std::span<const std::int64_t> offsets;
    std::span<const std::int32_t> vertices;
};

/// VTK's description of polyhedra.
struct CellDescriptions {
    /// Of each cell: how many faces; of each of these: how many corners, and the corners.
    Array<std::int64_t> faces;
    Array<std::int64_t> vertices;  ///< of each cell, every one once, ascending
    Array<std::int64_t> counts;    ///< how many vertices each cell has
    Array<std::int64_t> lengths;   ///< how many numbers of `faces` describe each cell
};

/// @param begin  where the sides of each of these cells begin, and the last one's end
/// @param cell_faces  2 face, or 2 face + 1 where the cell sees the face turned
///                    (strata::faces_of_cell)
/// @throws InputError kind bad_index
CellDescriptions describe_cells(const FaceLoops& faces, std::span<const std::uint32_t> begin,
                                std::span<const std::uint32_t> cell_faces);

/// The faces between two cells, by the lower of their cells and then the higher.
/// @param cells  how many there are
/// @throws InputError kind bad_index
Array<std::int64_t> inner_faces(std::span<const std::array<std::int32_t, 2>> face_cells,
                                std::size_t cells);

struct OrderedFaces {
    Array<std::int32_t> offsets, vertices;
    Array<std::int32_t> owner, neighbor;  ///< the lower cell, and the higher one; -1: outside
    Array<std::uint8_t> turned;           ///< whether the loop goes the other way round
};

/// Some faces in a new order, each seen from its lower cell: those whose first cell is the higher
/// are turned; their first corner stays.
/// @param face_cells  both cells of each of `faces`, the second -1 outside
/// @throws InputError kinds bad_index, too_large
OrderedFaces ordered_faces(const FaceLoops& faces,
                           std::span<const std::array<std::int32_t, 2>> face_cells,
                           std::span<const std::int64_t> order);

}  // namespace realmodel::simulation
