// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/halves.hpp"

#include "cutting/chunked_complex.hpp"
#include "cutting/near_part.hpp"
#include "strata/cells/volumes.hpp"

namespace realmodel::cutting {

namespace {

/// Numbers nodes anew in the order in which they come up.
class Renumbering {
public:
    Renumbering(const ComplexView& model, const std::vector<Position>& new_positions,
                Array<Position>& vertices)
        : model_(model),
          new_positions_(new_positions),
          vertices_(vertices),
          number_(model.vertex_count() + new_positions.size(), -1) {}

    std::int32_t operator()(NodeId node) {
        auto& number = number_[index(node)];
        if (number < 0) {
            number = static_cast<std::int32_t>(vertices_.size());
            const std::size_t own = model_.vertex_count();
            vertices_.push_back(index(node) < own ? model_.vertex(node)
                                                  : new_positions_[index(node) - own]);
        }
        return number;
    }

private:
    const ComplexView& model_;
    const std::vector<Position>& new_positions_;
    Array<Position>& vertices_;
    std::vector<std::int32_t> number_;
};

/// One half while it is put together.
struct Half {
    Half(CellComplex& to, std::vector<std::int32_t>& cells, std::size_t nodes, std::size_t chunks,
         const Execution& execution)
        : complex(to), origin(cells), chunked(to, nodes, chunks, execution) {}

    CellComplex& complex;
    std::vector<std::int32_t>& origin;
    ChunkedComplex chunked;
};

/// Puts both halves together.
/// @param near    the pieces that may be in the section
/// @param pieces  chunks() of them; each_of(chunk, visit) calls visit(polygon, piece)
template <class Chunks>
Cut assemble_all(const ComplexView& model, const std::vector<Position>& new_positions,
                 const CutPieces& near, const Chunks& pieces,
                 const std::vector<HalfCell>& half_cells, const Execution& execution) {
    Cut cut;
    const std::size_t own_nodes = model.vertex_count(), chunks = pieces.chunks();
    std::array<Half, 2> halves{
        Half(cut.below, cut.below_cells, own_nodes + new_positions.size(), chunks, execution),
        Half(cut.above, cut.above_cells, own_nodes + new_positions.size(), chunks, execution)};
    const auto half_of = [&](std::int32_t part) {
        return half_cells[index(part)].side == kBelow ? std::size_t{0} : std::size_t{1};
    };
    Array<std::int32_t> number(half_cells.size());
    for (std::size_t i = 0; i < half_cells.size(); ++i) {
        Half& half = halves[half_of(static_cast<std::int32_t>(i))];
        number[i] = static_cast<std::int32_t>(half.origin.size());
        half.origin.push_back(half_cells[i].cell);
        half.complex.cell_block.push_back(model.block(half_cells[i].cell));
    }
    // calls visit(half, nodes, piece, cells in the half) for what the halves have of a chunk
    const auto each_of_half = [&](std::size_t chunk, const auto& visit) {
        pieces.each_of(chunk, [&](std::span<const NodeId> nodes, const CutPiece& piece) {
            std::array<std::array<std::int32_t, 2>, 2> own{{{-1, -1}, {-1, -1}}};
            for (std::size_t k = 0; k < 2; ++k) {
                const std::int32_t part = piece.parts[k];
                if (part >= 0) own[half_of(part)][k] = number[index(part)];
            }
            for (std::size_t h = 0; h < 2; ++h) {
                if (own[h][0] >= 0 || own[h][1] >= 0) visit(halves[h], nodes, piece, own[h]);
            }
        });
    };
    parallel_chunks(chunks + 1, execution, [&](std::size_t chunk) {
        if (chunk == 0) {
            cut.section = assemble_section(model, new_positions, near);
            return;
        }
        each_of_half(chunk - 1, [&](Half& half, const auto& nodes, const CutPiece&, const auto&) {
            half.chunked.count(chunk - 1, nodes.size());
        });
    });
    for (Half& half : halves)
        half.chunked.make_room();
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        std::array<ChunkedComplex::Writer, 2> writers{
            ChunkedComplex::Writer(halves[0].chunked, chunk),
            ChunkedComplex::Writer(halves[1].chunked, chunk)};
        each_of_half(chunk, [&](Half& half, std::span<const NodeId> nodes, const CutPiece& piece,
                                const std::array<std::int32_t, 2>& own) {
            const bool is_exposed = (own[0] < 0 || own[1] < 0) && piece.cells[1] >= 0;
            writers[static_cast<std::size_t>(&half - halves.data())].write(
                nodes, own,
                is_exposed || piece.face < 0 ? kCutFace : model.face_surface[index(piece.face)]);
        });
    });
    for (Half& half : halves) {
        half.chunked.number([&](NodeId node) {
            return index(node) < own_nodes ? model.vertex(node)
                                           : new_positions[index(node) - own_nodes];
        });
        half.complex.cell_kind = model.cell_kind;
        half.complex.volumes = strata::block_volumes(half.complex, model.blocks, execution);
    }
    return cut;
}

/// Pieces in chunks.
struct ChunkedPieces {
    static constexpr std::size_t kChunk = 1 << 14;

    std::size_t chunks() const { return (pieces.size() + kChunk - 1) / kChunk; }
    template <class Visit>
    void each_of(std::size_t chunk, const Visit& visit) const {
        const std::size_t begin = chunk * kChunk;
        for (std::size_t p = begin; p < std::min(pieces.size(), begin + kChunk); ++p)
            visit(pieces.polygons[p], pieces[p]);
    }

    const CutPieces& pieces;
};

}  // namespace

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const CutPieces& pieces, const std::vector<HalfCell>& half_cells,
                    const Execution& execution) {
    return assemble_all(model, new_positions, pieces, ChunkedPieces{pieces}, half_cells, execution);
}

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const WholePieces& pieces, const std::vector<HalfCell>& half_cells,
                    const Execution& execution) {
    return assemble_all(model, new_positions, pieces.near(), pieces, half_cells, execution);
}

Section assemble_section(const ComplexView& model, const std::vector<Position>& new_positions,
                         const CutPieces& pieces) {
    Section section;
    Renumbering renumbered(model, new_positions, section.vertices);
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (!pieces[p].is_in_section()) continue;
        const auto& sides = pieces[p].sides;
        const bool reversed = sides[0] == kAbove || sides[1] == kBelow;
        const auto nodes = pieces.polygons[p];
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            section.polygon_vertices.push_back(
                renumbered(reversed ? nodes[nodes.size() - 1 - i] : nodes[i]));
        }
        section.offsets.push_back(static_cast<std::int64_t>(section.polygon_vertices.size()));
        const auto& cells = pieces[p].cells;
        section.cells.push_back(reversed ? std::array{cells[1], cells[0]} : cells);
    }
    return section;
}

}  // namespace realmodel::cutting
