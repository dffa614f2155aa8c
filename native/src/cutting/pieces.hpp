// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cutting/plane_edges.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Faces of a model cut up by a cutter, and the caps: what halves are put together from. A piece
/// turns counter-clockwise seen from outside of the first of its two cells. A cap has one cell
/// twice: first the part below it, then the part above.
struct Pieces {
    Polygons polygons;
    std::vector<std::int32_t> face;                  ///< the model's face, -1 a cap
    std::vector<std::array<std::int32_t, 2>> cells;  ///< the model's cells, -1 outside
    std::vector<std::array<std::int8_t, 2>> sides;   ///< of either cell's part; kOn: no cell there
    std::vector<std::uint8_t> level;                 ///< 1 where it lies on the cutter

    std::size_t size() const { return face.size(); }
    /// Whether it belongs to the section: between the halves, or where one of them ends.
    bool in_section(std::size_t p) const { return level[p] != 0 && sides[p][0] != sides[p][1]; }
};

/// A piece as one of its cells sees it.
struct PieceRef {
    std::int32_t piece = 0;
    std::int32_t which = 0;  ///< 0 or 1: whose outside its polygon turns counter-clockwise from
};

/// The pieces of each cell that is cut.
struct CellPieces {
    std::vector<std::int32_t> cells;  ///< the model's numbers of the cells that are cut, ascending
    std::vector<std::int64_t> offsets{0};
    std::vector<PieceRef> refs;

    std::span<const PieceRef> operator[](std::size_t i) const {
        return {refs.data() + offsets[i], static_cast<std::size_t>(offsets[i + 1] - offsets[i])};
    }
};

}  // namespace realmodel::cutting
