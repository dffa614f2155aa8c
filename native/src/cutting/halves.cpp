// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/halves.hpp"

#include "base/parallel.hpp"
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

/// @param each  each(visit) calls visit(polygon, piece) for all pieces
template <class Each>
void assemble(const ComplexView& model, const std::vector<Position>& new_positions,
              const Each& each, const std::vector<HalfCell>& cells, std::int8_t half,
              CellComplex& complex, std::vector<std::int32_t>& origin, const Progress* progress) {
    std::vector<std::int32_t> number(cells.size(), -1);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (cells[i].side != half) continue;
        number[i] = static_cast<std::int32_t>(origin.size());
        origin.push_back(cells[i].cell);
        complex.cell_block.push_back(model.block(cells[i].cell));
    }
    Renumbering renumbered(model, new_positions, complex.vertices);
    complex.face_offsets.push_back(0);
    std::size_t visited = 0;
    each([&](std::span<const NodeId> nodes, const Piece& piece) {
        poll(progress, visited++);
        std::array<std::int32_t, 2> own{-1, -1};
        for (std::size_t k = 0; k < 2; ++k) {
            if (piece.parts[k] >= 0) own[k] = number[index(piece.parts[k])];
        }
        if (own[0] < 0 && own[1] < 0) return;
        const bool reversed = own[0] < 0;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            complex.face_vertices.push_back(
                renumbered(reversed ? nodes[nodes.size() - 1 - i] : nodes[i]));
        }
        complex.face_offsets.push_back(static_cast<std::int64_t>(complex.face_vertices.size()));
        complex.face_cells.push_back(reversed ? std::array{own[1], -1} : own);
        const bool is_exposed = (own[0] < 0 || own[1] < 0) && piece.cells[1] >= 0;
        complex.face_surface.push_back(
            is_exposed || piece.face < 0 ? kCutFace : model.face_surface[index(piece.face)]);
    });
}

/// @param near  the pieces that may be in the section
template <class Each>
Cut assemble_all(const ComplexView& model, const std::vector<Position>& new_positions,
                 const Pieces& near, const Each& each, const std::vector<HalfCell>& half_cells,
                 int threads, Progress* progress) {
    Cut cut;
    parallel_chunks(3, threads, progress, [&](std::size_t which) {
        if (which == 0) {
            assemble(model, new_positions, each, half_cells, kBelow, cut.below, cut.below_cells,
                     progress);
        } else if (which == 1) {
            assemble(model, new_positions, each, half_cells, kAbove, cut.above, cut.above_cells,
                     progress);
        } else {
            cut.section = assemble_section(model, new_positions, near);
        }
    });
    for (CellComplex* half : {&cut.below, &cut.above}) {
        half->cell_kind = model.cell_kind;
        half->volumes = strata::block_volumes(*half, model.blocks, threads, progress);
    }
    return cut;
}

}  // namespace

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const Pieces& pieces, const std::vector<HalfCell>& half_cells, int threads,
                    Progress* progress) {
    const auto each = [&pieces](const auto& visit) {
        for (std::size_t p = 0; p < pieces.size(); ++p)
            visit(pieces.polygons[p], pieces[p]);
    };
    return assemble_all(model, new_positions, pieces, each, half_cells, threads, progress);
}

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const WholePieces& pieces, const std::vector<HalfCell>& half_cells, int threads,
                    Progress* progress) {
    const auto each = [&pieces](const auto& visit) { pieces.each(visit); };
    return assemble_all(model, new_positions, pieces.near(), each, half_cells, threads, progress);
}

Section assemble_section(const ComplexView& model, const std::vector<Position>& new_positions,
                         const Pieces& pieces) {
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
