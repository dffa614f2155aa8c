// SPDX-License-Identifier: GPL-3.0-or-later
/// Cells and faces in the order in which files of polyhedra want them.
#pragma once

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
};

/// @param begin  where the sides of each of these cells begin, and the last one's end
/// @param sides  2 face, or 2 face + 1 where the cell sees the face turned (strata::cell_sides)
/// @throws InputError kind bad_index
CellDescriptions describe_cells(const FaceLoops& faces, std::span<const std::int64_t> begin,
                                std::span<const std::int64_t> sides);

struct OrderedFaces {
    Array<std::int32_t> offsets, vertices;
};

/// Some faces in a new order.
/// @param turned  of each of `order`: whether its loop goes the other way round; the first corner
/// stays
/// @throws InputError kinds bad_index, too_large
OrderedFaces ordered_faces(const FaceLoops& faces, std::span<const std::int64_t> order,
                           std::span<const std::uint8_t> turned);

}  // namespace realmodel::simulation
