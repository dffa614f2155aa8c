// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

/// Numbers the nodes of many polygons anew in the order in which they come up, on several threads:
/// of each node it is found in which chunk it comes up first, and in each chunk the nodes that do
/// are numbered in their order there.
class ParallelNumbering {
public:
    ParallelNumbering(std::size_t nodes, std::size_t chunks, const Execution& execution)
        : execution_(execution), nodes_(nodes), first_of_(chunks) {
        parallel_ranges(nodes, kNodes, execution, [&](std::size_t begin, std::size_t end) {
            std::fill(nodes_.begin() + begin, nodes_.begin() + end, NumberedNode{UINT32_MAX, -1});
        });
    }
    /// Notes that a node comes up in a chunk: of one chunk one thread does, in order.
    void meet(std::size_t chunk, NodeId node) {
        std::uint32_t& first = nodes_[index(node)].chunk;
        const auto chunk_number = static_cast<std::uint32_t>(chunk);
        if (std::atomic_ref(first).load(std::memory_order_relaxed) <= chunk_number) return;
        first_of_[chunk].push_back(node);
        atomic_min_by(first, chunk_number, std::less<>());
    }
    /// Writes the positions of all that came up, by their new numbers.
    template <class PositionOf>
    void number(const PositionOf& position_of, Array<Position>& positions) {
        std::vector<std::size_t> before(first_of_.size());
        parallel_chunks(first_of_.size(), execution_, [&](std::size_t chunk) {
            // what another chunk before this one turned out to have first is taken away
            std::erase_if(first_of_[chunk], [&](NodeId node) {
                return nodes_[index(node)].chunk != static_cast<std::uint32_t>(chunk);
            });
            before[chunk] = first_of_[chunk].size();
        });
        positions.resize(exclusive_scan(before));
        checked_number(positions.size(), "vertices of a model");
        parallel_chunks(first_of_.size(), execution_, [&](std::size_t chunk) {
            std::size_t next = before[chunk];
            for (const NodeId node : first_of_[chunk]) {
                nodes_[index(node)].number = static_cast<std::int32_t>(next);
                positions[next++] = position_of(node);
            }
            first_of_[chunk] = {};
        });
    }
    std::int32_t operator[](NodeId node) const { return nodes_[index(node)].number; }

private:
    static constexpr std::size_t kNodes = 1 << 16;
    struct NumberedNode {
        std::uint32_t chunk;  ///< in which it comes up first
        std::int32_t number;
    };

    Execution execution_;
    Array<NumberedNode> nodes_;
    std::vector<std::vector<NodeId>> first_of_;  ///< of chunks
};

/// The faces of a model that several threads put together in chunks: all are counted, then written,
/// with the old numbers of nodes, and last these are replaced.
class ChunkedComplex {
public:
    ChunkedComplex(CellComplex& to, std::size_t nodes, std::size_t chunks,
                   const Execution& execution)
        : to_(to),
          execution_(execution),
          numbering_(nodes, chunks, execution),
          faces_(chunks),
          corners_(chunks) {}

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
            : of_(of), chunk_(chunk), face_(of.faces_[chunk]), corner_(of.corners_[chunk]) {}

        /// @param cells  behind and ahead, -1 none: where there is none behind it is turned around
        void write(std::span<const NodeId> nodes, const std::array<std::int32_t, 2>& cells,
                   std::int32_t surface) {
            CellComplex& to = of_.to_;
            const bool reversed = cells[0] < 0;
            to.face_offsets[face_] = static_cast<std::int64_t>(corner_);
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const NodeId node = reversed ? nodes[nodes.size() - 1 - i] : nodes[i];
                to.face_vertices[corner_++] = node;
                of_.numbering_.meet(chunk_, node);
            }
            to.face_cells[face_] = reversed ? std::array{cells[1], -1} : cells;
            to.face_surface[face_++] = surface;
        }

    private:
        ChunkedComplex& of_;
        std::size_t chunk_, face_, corner_;
    };
    template <class PositionOf>
    void number(const PositionOf& position_of) {
        numbering_.number(position_of, to_.vertices);
        auto& nodes = to_.face_vertices;
        parallel_ranges(nodes.size(), 1 << 16, execution_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                nodes[i] = numbering_[nodes[i]];
        });
    }

private:
    CellComplex& to_;
    Execution execution_;
    ParallelNumbering numbering_;
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
