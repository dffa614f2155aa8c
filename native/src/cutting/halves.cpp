// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/halves.hpp"

#include <atomic>

#include "base/parallel_counts.hpp"
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

/// Numbers the nodes of many polygons anew in the order in which they come up, on several threads:
/// of each node it is found in which chunk it comes up first, and in each chunk the nodes that do
/// are numbered in their order there.
class ParallelNumbering {
public:
    ParallelNumbering(std::size_t nodes, std::size_t chunks, int threads, const Progress* progress)
        : threads_(threads), progress_(progress), nodes_(nodes), first_of_(chunks) {
        parallel_ranges(nodes, kNodes, threads, progress, [&](std::size_t begin, std::size_t end) {
            std::fill(nodes_.begin() + begin, nodes_.begin() + end, Node{UINT32_MAX, -1});
        });
    }
    /// Notes that a node comes up in a chunk: of one chunk one thread does, in order.
    void meet(std::size_t chunk, NodeId node) {
        const std::atomic_ref first(nodes_[index(node)].chunk);
        auto known = first.load(std::memory_order_relaxed);
        const auto own = static_cast<std::uint32_t>(chunk);
        if (known <= own) return;
        first_of_[chunk].push_back(node);
        while (known > own && !first.compare_exchange_weak(known, own, std::memory_order_relaxed)) {
        }
    }
    /// Writes the positions of all that came up, by their new numbers.
    template <class PositionOf>
    void number(const PositionOf& position_of, Array<Position>& positions) {
        std::vector<std::size_t> before(first_of_.size());
        parallel_chunks(first_of_.size(), threads_, progress_, [&](std::size_t chunk) {
            // what another chunk before this one turned out to have first is taken away
            std::erase_if(first_of_[chunk], [&](NodeId node) {
                return nodes_[index(node)].chunk != static_cast<std::uint32_t>(chunk);
            });
            before[chunk] = first_of_[chunk].size();
        });
        positions.resize(count_before(before));
        checked_number(positions.size(), "vertices of a half");
        parallel_chunks(first_of_.size(), threads_, progress_, [&](std::size_t chunk) {
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
    struct Node {
        std::uint32_t chunk;  ///< in which it comes up first
        std::int32_t number;
    };

    int threads_;
    const Progress* progress_;
    Array<Node> nodes_;
    std::vector<std::vector<NodeId>> first_of_;  ///< of chunks
};

/// One half while it is put together.
struct Half {
    Half(CellComplex& to, std::vector<std::int32_t>& cells, std::size_t nodes, std::size_t chunks,
         int threads, const Progress* progress)
        : complex(to),
          origin(cells),
          numbering(nodes, chunks, threads, progress),
          faces(chunks),
          corners(chunks) {}

    CellComplex& complex;
    std::vector<std::int32_t>& origin;
    ParallelNumbering numbering;
    std::vector<std::size_t> faces, corners;  ///< of chunks: how many, then how many before
};

/// Both halves are put together chunk by chunk of the pieces: first it is counted what each has in
/// them, then written there, with the old numbers of nodes, and last these are replaced.
/// @param near    the pieces that may be in the section
/// @param pieces  chunks() of them; each_of(chunk, visit) calls visit(polygon, piece)
template <class Chunks>
Cut assemble_all(const ComplexView& model, const std::vector<Position>& new_positions,
                 const Pieces& near, const Chunks& pieces, const std::vector<HalfCell>& half_cells,
                 int threads, Progress* progress) {
    Cut cut;
    const std::size_t own_nodes = model.vertex_count(), chunks = pieces.chunks();
    std::array<Half, 2> halves{Half(cut.below, cut.below_cells, own_nodes + new_positions.size(),
                                    chunks, threads, progress),
                               Half(cut.above, cut.above_cells, own_nodes + new_positions.size(),
                                    chunks, threads, progress)};
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
        pieces.each_of(chunk, [&](std::span<const NodeId> nodes, const Piece& piece) {
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
    parallel_chunks(chunks + 1, threads, progress, [&](std::size_t chunk) {
        if (chunk == 0) {
            cut.section = assemble_section(model, new_positions, near);
            return;
        }
        each_of_half(chunk - 1, [&](Half& half, const auto& nodes, const Piece&, const auto&) {
            ++half.faces[chunk - 1];
            half.corners[chunk - 1] += nodes.size();
        });
    });
    for (Half& half : halves) {
        const std::size_t faces = count_before(half.faces), corners = count_before(half.corners);
        half.complex.face_vertices.resize(corners);
        half.complex.face_offsets.resize(faces + 1);
        half.complex.face_offsets[faces] = static_cast<std::int64_t>(corners);
        half.complex.face_cells.resize(faces);
        half.complex.face_surface.resize(faces);
    }
    parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
        std::array<std::size_t, 2> face, corner;
        for (std::size_t h = 0; h < 2; ++h) {
            face[h] = halves[h].faces[chunk];
            corner[h] = halves[h].corners[chunk];
        }
        each_of_half(chunk, [&](Half& half, std::span<const NodeId> nodes, const Piece& piece,
                                const std::array<std::int32_t, 2>& own) {
            const auto h = static_cast<std::size_t>(&half - halves.data());
            const bool reversed = own[0] < 0;
            half.complex.face_offsets[face[h]] = static_cast<std::int64_t>(corner[h]);
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const NodeId node = reversed ? nodes[nodes.size() - 1 - i] : nodes[i];
                half.complex.face_vertices[corner[h]++] = node;
                half.numbering.meet(chunk, node);
            }
            half.complex.face_cells[face[h]] = reversed ? std::array{own[1], -1} : own;
            const bool is_exposed = (own[0] < 0 || own[1] < 0) && piece.cells[1] >= 0;
            half.complex.face_surface[face[h]++] =
                is_exposed || piece.face < 0 ? kCutFace : model.face_surface[index(piece.face)];
        });
    });
    for (Half& half : halves) {
        half.numbering.number(
            [&](NodeId node) {
                return index(node) < own_nodes ? model.vertex(node)
                                               : new_positions[index(node) - own_nodes];
            },
            half.complex.vertices);
        auto& nodes = half.complex.face_vertices;
        parallel_ranges(nodes.size(), 1 << 16, threads, progress,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i)
                                nodes[i] = half.numbering[nodes[i]];
                        });
        half.complex.cell_kind = model.cell_kind;
        half.complex.volumes = strata::block_volumes(half.complex, model.blocks, threads, progress);
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

    const Pieces& pieces;
};

}  // namespace

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const Pieces& pieces, const std::vector<HalfCell>& half_cells, int threads,
                    Progress* progress) {
    return assemble_all(model, new_positions, pieces, ChunkedPieces{pieces}, half_cells, threads,
                        progress);
}

Cut assemble_halves(const ComplexView& model, const std::vector<Position>& new_positions,
                    const WholePieces& pieces, const std::vector<HalfCell>& half_cells, int threads,
                    Progress* progress) {
    return assemble_all(model, new_positions, pieces.near(), pieces, half_cells, threads, progress);
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
