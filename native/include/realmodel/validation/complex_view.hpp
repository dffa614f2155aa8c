// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace realmodel::validation {

/// Polyhedral cells that share faces, as they are told of (docs/geometry.md): nothing is taken for
/// granted about the numbers inside.
struct ComplexView {
    std::span<const double> vertices;             ///< 3 V coordinates
    std::span<const std::int64_t> face_offsets;   ///< F + 1
    std::span<const std::int32_t> face_vertices;  ///< corners, face after face
    std::span<const std::int32_t> face_cells;     ///< 2 F; -1 is outside
    std::span<const std::int32_t> face_surface;   ///< F; -1 a wall, -2 the flat base
    std::span<const std::int32_t> cell_block;     ///< C
    std::span<const double> block_volume;         ///< B, as they are told
    std::span<const double> block_base;  ///< B: height of the base that a block stands on, or NaN
    std::int32_t surfaces = 0;           ///< how many there are that faces may name
    bool cells_are_blocks = false;       ///< an edge may be used more than once each way, balanced

    std::size_t face_count() const { return face_surface.size(); }
    std::size_t cell_count() const { return cell_block.size(); }
    std::size_t vertex_count() const { return vertices.size() / 3; }
    std::span<const std::int32_t> corners(std::size_t face) const {
        const auto begin = static_cast<std::size_t>(face_offsets[face]);
        return face_vertices.subspan(begin,
                                     static_cast<std::size_t>(face_offsets[face + 1]) - begin);
    }
    std::int32_t cell(std::size_t face, std::size_t side) const {
        return face_cells[2 * face + side];
    }
    std::array<double, 3> position(std::int32_t vertex) const {
        const double* row = &vertices[static_cast<std::size_t>(vertex) * 3];
        return {row[0], row[1], row[2]};
    }
    /// The block of a cell, -1 outside.
    std::int32_t block(std::int32_t of_cell) const {
        return of_cell < 0 ? -1 : cell_block[static_cast<std::size_t>(of_cell)];
    }
};

}  // namespace realmodel::validation
