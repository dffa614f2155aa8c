// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/index.hpp"
#include "base/parallel_counts.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

/// Numbers the nodes of polygons anew in the order in which they come up, and adds the positions of
/// all that do.
/// @param count  of nodes
template <class PositionOf>
void number_nodes(std::span<NodeId> polygons, std::size_t count, const PositionOf& position_of,
                  Array<Position>& positions) {
    std::vector<std::int32_t> number(count, -1);
    for (NodeId& node : polygons) {
        std::int32_t& vertex = number[index(node)];
        if (vertex < 0) {
            vertex = checked_number(positions.size(), "vertices of a model");
            positions.push_back(position_of(node));
        }
        node = vertex;
    }
}

/// The faces of a model that several threads put together in chunks: all are counted, then written,
/// with the old numbers of nodes (number_nodes).
class ChunkedComplex {
public:
    ChunkedComplex(CellComplex& to, std::size_t chunks)
        : to_(to), faces_(chunks), corners_(chunks) {}

    void count(std::size_t chunk, std::size_t corners) {
        ++faces_[chunk];
        corners_[chunk] += corners;
    }
    /// To be called between the last count() and the first Writer.
    void make_room() {
        const std::size_t faces = exclusive_scan(faces_), corners = exclusive_scan(corners_);
        to_.face_vertices.resize(corners);
        to_.face_offsets.resize(faces + 1);
        to_.face_offsets[faces] = static_cast<std::int64_t>(corners);
        to_.face_cells.resize(faces);
        to_.face_surface.resize(faces);
    }
    /// Writes the faces of a chunk.
    class Writer {
    public:
        Writer(ChunkedComplex& of, std::size_t chunk)
            : to_(of.to_), face_(of.faces_[chunk]), corner_(of.corners_[chunk]) {}

        /// @param cells  behind and ahead, -1 none: where there is none behind it is turned around
        void write(std::span<const NodeId> nodes, const std::array<std::int32_t, 2>& cells,
                   std::int32_t surface) {
            const bool reversed = cells[0] < 0;
            to_.face_offsets[face_] = static_cast<std::int64_t>(corner_);
            for (std::size_t i = 0; i < nodes.size(); ++i)
                to_.face_vertices[corner_++] = reversed ? nodes[nodes.size() - 1 - i] : nodes[i];
            to_.face_cells[face_] = reversed ? std::array{cells[1], -1} : cells;
            to_.face_surface[face_++] = surface;
        }

    private:
        CellComplex& to_;
        std::size_t face_, corner_;
    };

private:
    CellComplex& to_;
    std::vector<std::size_t> faces_, corners_;  ///< of chunks: how many, then how many before
};

class WholePieces;

/// Puts both halves and the section together. `new_positions` are those of the nodes after the
/// model's vertices.
Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const WholePieces& pieces, const std::vector<HalfCell>& half_cells,
                    const Execution& execution);

/// The pieces that lie on the cutter, each as it is seen from above.
Section assemble_section(const ComplexView& model, const std::vector<Position>& new_positions,
                         const CutPieces& pieces);

}  // namespace realmodel::cutting
