// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/structures/merge_cells.hpp"

#include <array>
#include <string>
#include <vector>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {

namespace {

/// The blocks of the new cells.
Array<std::int32_t> blocks_of_merged(const ComplexView& complex,
                                     std::span<const std::int32_t> number) {
    if (number.size() != complex.cell_count())
        throw InputError("bad_index", "the numbers of cells: one for each cell");
    Array<std::int32_t> blocks;
    for (std::size_t c = 0; c < number.size(); ++c) {
        const auto next = static_cast<std::int32_t>(blocks.size());
        if (number[c] < -1 || number[c] > next) {
            throw InputError("bad_index",
                             "cell " + std::to_string(c) + " gets the number " +
                                 std::to_string(number[c]) + ": the next new one is " +
                                 std::to_string(next),
                             -1, {static_cast<std::int64_t>(c)});
        }
        if (number[c] == next) blocks.push_back(complex.cell_block[c]);
    }
    return blocks;
}

/// Takes the vertices that are in use, and numbers the corners of faces by them.
void take_vertices(const ComplexView& from, CellComplex& to) {
    std::vector<std::int32_t> vertex(from.vertex_count(), -1);
    for (const std::int32_t v : to.face_vertices)
        vertex[index(v)] = 0;
    for (std::size_t v = 0; v < vertex.size(); ++v) {
        if (vertex[v] < 0) continue;
        vertex[v] = static_cast<std::int32_t>(to.vertices.size());
        to.vertices.push_back(from.vertex(static_cast<std::int32_t>(v)));
    }
    for (std::int32_t& v : to.face_vertices)
        v = vertex[index(v)];
}

}  // namespace

CellComplex merge_cells(const ComplexView& complex, std::span<const std::int32_t> number,
                        Progress* progress) {
    cutting::check_model(complex);
    CellComplex merged;
    merged.cell_kind = complex.cell_kind;
    merged.cell_block = blocks_of_merged(complex, number);
    merged.face_offsets.push_back(0);
    const auto new_cell = [&](std::size_t f, std::size_t side) {
        const std::int32_t cell = complex.cell(f, side);
        return cell < 0 ? -1 : number[index(cell)];
    };
    for (std::size_t f = 0; f < complex.face_count(); ++f) {
        poll(progress, f);
        const std::array cells{new_cell(f, 0), new_cell(f, 1)};
        if (cells[0] == cells[1]) continue;
        const auto corners = complex.face(f);
        if (cells[0] >= 0) {
            merged.face_vertices.append(corners.begin(), corners.end());
            merged.face_cells.push_back(cells);
        } else {
            merged.face_vertices.append(corners.rbegin(), corners.rend());
            merged.face_cells.push_back({cells[1], cells[0]});
        }
        merged.face_offsets.push_back(static_cast<std::int64_t>(merged.face_vertices.size()));
        merged.face_surface.push_back(complex.face_surface[f]);
    }
    take_vertices(complex, merged);
    return merged;
}

}  // namespace realmodel::structures
