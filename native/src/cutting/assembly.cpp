// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/assembly.hpp"

#include "cutting/near_model.hpp"
#include "strata/cells/volumes.hpp"

namespace realmodel::cutting {

namespace {

/// The position of a node: of the model's vertices, or of the new nodes after them.
Position position_of(const ComplexView& model, const std::vector<Position>& new_positions,
                     NodeId node) {
    const std::size_t vertices = model.vertex_count();
    return index(node) < vertices ? model.vertex(node) : new_positions[index(node) - vertices];
}

/// One half while it is put together.
struct HalfAssembly {
    HalfAssembly(CellComplex& to, std::vector<std::int32_t>& cells, std::size_t chunks)
        : complex(to), origin(cells), chunked(to, chunks) {}

    CellComplex& complex;
    std::vector<std::int32_t>& origin;
    ChunkedComplex chunked;
};

}  // namespace

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const WholePieces& pieces, const std::vector<HalfCell>& half_cells,
                    const Execution& execution) {
    Cut cut;
    const std::size_t nodes = model.vertex_count() + new_positions.size(), chunks = pieces.chunks();
    std::array<HalfAssembly, 2> halves{HalfAssembly(cut.below, cut.below_cells, chunks),
                                       HalfAssembly(cut.above, cut.above_cells, chunks)};
    const auto half_of = [&](std::int32_t part) {
        return half_cells[index(part)].side == kBelow ? std::size_t{0} : std::size_t{1};
    };
    Array<std::int32_t> number(half_cells.size());
    for (std::size_t i = 0; i < half_cells.size(); ++i) {
        HalfAssembly& half = halves[half_of(static_cast<std::int32_t>(i))];
        number[i] = static_cast<std::int32_t>(half.origin.size());
        half.origin.push_back(half_cells[i].cell);
        half.complex.cell_block.push_back(model.block(half_cells[i].cell));
    }
    // calls visit(half, polygon, piece, cells in the half) for what the halves have of a chunk
    const auto for_each_of_half = [&](std::size_t chunk, const auto& visit) {
        pieces.for_each_of(chunk, [&](std::span<const NodeId> polygon, const CutPiece& piece) {
            std::array<std::array<std::int32_t, 2>, 2> cells{{{-1, -1}, {-1, -1}}};
            for (std::size_t k = 0; k < 2; ++k) {
                const std::int32_t part = piece.parts[k];
                if (part >= 0) cells[half_of(part)][k] = number[index(part)];
            }
            for (std::size_t h = 0; h < 2; ++h) {
                if (cells[h][0] >= 0 || cells[h][1] >= 0)
                    visit(halves[h], polygon, piece, cells[h]);
            }
        });
    };
    parallel_chunks(chunks + 1, execution, [&](std::size_t chunk) {
        if (chunk == 0) {
            cut.section = assemble_section(model, new_positions, pieces.near());
            return;
        }
        for_each_of_half(
            chunk - 1, [&](HalfAssembly& half, const auto& polygon, const CutPiece&, const auto&) {
                half.chunked.count(chunk - 1, polygon.size());
            });
    });
    for (HalfAssembly& half : halves)
        half.chunked.make_room();
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        std::array<ChunkedComplex::Writer, 2> writers{
            ChunkedComplex::Writer(halves[0].chunked, chunk),
            ChunkedComplex::Writer(halves[1].chunked, chunk)};
        for_each_of_half(chunk, [&](HalfAssembly& half, std::span<const NodeId> polygon,
                                    const CutPiece& piece,
                                    const std::array<std::int32_t, 2>& cells) {
            const bool is_exposed = (cells[0] < 0 || cells[1] < 0) && piece.cells[1] >= 0;
            writers[static_cast<std::size_t>(&half - halves.data())].write(
                polygon, cells,
                is_exposed || piece.face < 0 ? kCutFace : model.face_surface[index(piece.face)]);
        });
    });
    parallel_chunks(2, execution, [&](std::size_t h) {
        CellComplex& complex = halves[h].complex;
        number_nodes(
            complex.face_vertices, nodes,
            [&](NodeId node) { return position_of(model, new_positions, node); }, complex.vertices);
    });
    for (HalfAssembly& half : halves) {
        half.complex.cell_kind = model.cell_kind;
        half.complex.volumes = strata::block_volumes(half.complex, model.blocks, execution);
    }
    return cut;
}

Section assemble_section(const ComplexView& model, const std::vector<Position>& new_positions,
                         const CutPieces& pieces) {
    Section section;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (!pieces[p].is_in_section()) continue;
        const auto& sides = pieces[p].sides;
        const bool reversed = sides[0] == kAbove || sides[1] == kBelow;
        const auto nodes = pieces.polygons[p];
        for (std::size_t i = 0; i < nodes.size(); ++i)
            section.polygon_vertices.push_back(reversed ? nodes[nodes.size() - 1 - i] : nodes[i]);
        section.offsets.push_back(static_cast<std::int64_t>(section.polygon_vertices.size()));
        const auto& cells = pieces[p].cells;
        section.cells.push_back(reversed ? std::array{cells[1], cells[0]} : cells);
    }
    number_nodes(
        section.polygon_vertices, model.vertex_count() + new_positions.size(),
        [&](NodeId node) { return position_of(model, new_positions, node); }, section.vertices);
    return section;
}

}  // namespace realmodel::cutting
