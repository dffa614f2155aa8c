// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/disjoint_sets.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// An independent way to the blocks of a model: columns with each connected part of a block as one
/// cell; walls between cells of one block are left out.
inline CellComplex merge_columns(const CellComplex& columns) {
    const auto block = [&](std::int32_t cell) {
        return columns.cell_block[static_cast<std::size_t>(cell)];
    };
    const auto within_block = [&](const std::array<std::int32_t, 2>& cells) {
        return cells[1] >= 0 && block(cells[0]) == block(cells[1]);
    };
    DisjointSets parts(columns.cell_block.size());
    for (std::size_t f = 0; f < columns.face_cells.size(); ++f) {
        const auto& cells = columns.face_cells[f];
        if (within_block(cells)) parts.join(cells[0], cells[1]);
    }
    CellComplex merged;
    std::vector<std::int32_t> part_of(columns.cell_block.size(), -1);
    for (std::size_t c = 0; c < part_of.size(); ++c) {
        const auto root = static_cast<std::size_t>(parts.find(static_cast<std::int32_t>(c)));
        if (part_of[root] < 0) {
            part_of[root] = static_cast<std::int32_t>(merged.cell_block.size());
            merged.cell_block.push_back(columns.cell_block[c]);
        }
        part_of[c] = part_of[root];
    }
    std::vector<std::int32_t> vertex_of(columns.vertices.size(), -1);
    merged.face_offsets.push_back(0);
    for (std::size_t f = 0; f < columns.face_cells.size(); ++f) {
        const auto& cells = columns.face_cells[f];
        if (within_block(cells)) continue;
        for (auto i = columns.face_offsets[f]; i < columns.face_offsets[f + 1]; ++i) {
            const auto v =
                static_cast<std::size_t>(columns.face_vertices[static_cast<std::size_t>(i)]);
            if (vertex_of[v] < 0) {
                vertex_of[v] = static_cast<std::int32_t>(merged.vertices.size());
                merged.vertices.push_back(columns.vertices[v]);
            }
            merged.face_vertices.push_back(vertex_of[v]);
        }
        merged.face_offsets.push_back(static_cast<std::int64_t>(merged.face_vertices.size()));
        merged.face_cells.push_back(
            {part_of[static_cast<std::size_t>(cells[0])],
             cells[1] < 0 ? -1 : part_of[static_cast<std::size_t>(cells[1])]});
        merged.face_surface.push_back(columns.face_surface[f]);
    }
    merged.cell_kind = CellKind::kBlocks;
    merged.volumes = columns.volumes;
    merged.warnings = columns.warnings;
    merged.decisions = columns.decisions;
    merged.exact_decisions = columns.exact_decisions;
    return merged;
}

}  // namespace realmodel::strata
