// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "realmodel/base/array.hpp"

namespace realmodel {

/// What a cell is.
enum class CellKind {
    kColumns,  ///< what lies under one facet of the surface above it
    kBlocks  ///< a connected component of a block; its faces may touch along edges, so that it uses
             ///< an edge more than twice, as often either way
};

// What a face lies on, where that is no surface.
inline constexpr std::int32_t kWall = -1;  ///< a vertical wall
inline constexpr std::int32_t kBase = -2;  ///< the flat base
/// The face that a cut made (realmodel/cutting): it lies between the two halves.
inline constexpr std::int32_t kCutFace = -3;

/// A view of a cell complex: polyhedral cells that share faces (docs/dev/geometry.md), wherever the
/// arrays come from. Nothing is taken for granted about the numbers inside.
struct ComplexView {
    std::span<const double> vertices;             ///< 3 V coordinates
    std::span<const std::int64_t> face_offsets;   ///< F + 1
    std::span<const std::int32_t> face_vertices;  ///< counter-clockwise from outside the first cell
    std::span<const std::int32_t> face_cells;     ///< 2 F; -1 is outside; the first never is
    std::span<const std::int32_t> face_surface;   ///< F; kWall, kBase, kCutFace; else a surface
    std::span<const std::int32_t> cell_block;     ///< C
    std::size_t blocks = 0;                       ///< B: cell_block counts below this
    std::int32_t surfaces = 0;                    ///< face_surface counts below this
    CellKind cell_kind = CellKind::kColumns;
    std::span<const double> block_volume = {};  ///< B, as they are stated
    std::span<const double> block_base = {};    ///< B: height of the base below a block, or NaN

    std::size_t face_count() const { return face_cells.size() / 2; }
    std::size_t cell_count() const { return cell_block.size(); }
    std::size_t vertex_count() const { return vertices.size() / 3; }
    std::span<const std::int32_t> face(std::size_t f) const {
        const auto begin = static_cast<std::size_t>(face_offsets[f]);
        return face_vertices.subspan(begin, static_cast<std::size_t>(face_offsets[f + 1]) - begin);
    }
    std::array<double, 3> vertex(std::int32_t v) const {
        const double* row = &vertices[static_cast<std::size_t>(v) * 3];
        return {row[0], row[1], row[2]};
    }
    std::int32_t cell(std::size_t f, std::size_t side) const { return face_cells[2 * f + side]; }
    /// The block of a cell, -1 outside.
    std::int32_t block(std::int32_t of_cell) const {
        return of_cell < 0 ? -1 : cell_block[static_cast<std::size_t>(of_cell)];
    }
};

/// What was left out of the input, and why.
struct Warning {
    std::string kind;
    int surface = -1;
    std::vector<std::int64_t> items;
    std::string text;

    bool operator==(const Warning&) const = default;
};

/// Polyhedral cells that share faces exactly (the layout that OpenFOAM calls owner / neighbour),
/// with their arrays. Wherever a ComplexView is asked for, it is one.
struct CellComplex {
    Array<std::array<double, 3>> vertices;
    Array<std::int64_t> face_offsets;
    Array<std::int32_t> face_vertices;
    Array<std::array<std::int32_t, 2>> face_cells;
    Array<std::int32_t> face_surface;
    /// The surface that the cell's block lies beneath; of the oldest surface of a rock mass: the
    /// block between it and the base. Surfaces are counted through all rock masses.
    Array<std::int32_t> cell_block;
    CellKind cell_kind = CellKind::kColumns;
    std::vector<double> volumes;  ///< of the block beneath each surface
    std::vector<Warning> warnings;
    std::uint64_t decisions = 0;        ///< how many signs were asked
    std::uint64_t exact_decisions = 0;  ///< how many of them needed exact arithmetic

    operator ComplexView() const {
        return {.vertices = {reinterpret_cast<const double*>(vertices.data()), 3 * vertices.size()},
                .face_offsets = face_offsets,
                .face_vertices = face_vertices,
                .face_cells = {reinterpret_cast<const std::int32_t*>(face_cells.data()),
                               2 * face_cells.size()},
                .face_surface = face_surface,
                .cell_block = cell_block,
                .blocks = volumes.size(),
                .surfaces = static_cast<std::int32_t>(volumes.size()),
                .cell_kind = cell_kind,
                .block_volume = volumes};
    }
};

}  // namespace realmodel
