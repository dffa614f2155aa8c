// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "base/packed_pair.hpp"
#include "cutting/pieces.hpp"
#include "cutting/plane_points.hpp"

namespace realmodel::cutting {

/// How a plane divides one cell.
struct CellCut {
    Polygons caps;         ///< counter-clockwise seen from above
    bool is_clean = true;  ///< false: what bounds them crosses itself, or runs back along itself
    /// The part of the cell that each of its pieces belongs to, then, cap after cap, the part below
    /// it and the part above it. Parts are counted in the order of their first piece.
    std::vector<std::int32_t> part;
    std::vector<std::int8_t> part_side;
};

/// Closes the parts of cells where a plane has cut them.
///
/// The edges in the plane that the pieces above it leave open bound the caps. Along an edge of the
/// cell that only touches the plane nothing is open; whether the caps pass on both of its sides or
/// on neither follows from which of the two faces there is steeper.
class CellCutter {
public:
    CellCutter(const ComplexView& model, const std::vector<std::int8_t>& sides,
               const EdgeIntersections& cuts, const CutPieces& pieces,
               const exact::OrientedPlane& plane)
        : model_(model), sides_(sides), cuts_(cuts), pieces_(pieces), points_(model, plane, cuts) {}

    /// The caps alone.
    void cap(std::span<const PieceRef> refs, CellCut& result);
    /// Caps and parts.
    void cut(std::span<const PieceRef> refs, CellCut& result);

private:
    /// One edge of one piece, as its cell sees it.
    struct Use {
        std::array<NodeId, 2> edge;  ///< lesser, greater node
        std::int32_t local;          ///< number among the cell's pieces
        std::int8_t direction;       ///< 1 from lesser to greater, -1 back
        std::int8_t side;
        bool level;  ///< the piece lies in the plane

        std::uint64_t key() const { return packed_pair(edge[0], edge[1]); }
        bool operator<(const Use& other) const {
            return key() != other.key() ? key() < other.key() : local < other.local;
        }
    };
    struct DirectedEdge {
        NodeId from, to;
    };

    Position position(NodeId node) const { return points_.rounded(node); }
    LoopCorner corner(NodeId node) const { return {node, points_.view()(points_.rounded(node))}; }
    bool in_plane(NodeId node) const { return cuts_.contains(node) || sides_[index(node)] == kOn; }
    void collect_uses(std::span<const PieceRef> refs, bool in_plane_only);
    void close(std::span<const PieceRef> refs, CellCut& result);
    void collect_open_edges(std::span<const PieceRef> refs);
    bool caps_on_both_sides(std::span<const Use> uses, std::span<const PieceRef> refs) const;
    bool is_in_caps(const std::array<NodeId, 2>& edge) const;
    void keep_slits_in_caps();
    NodeId far_node(const Use& use, std::span<const PieceRef> refs) const;
    void trace_loops();
    void take_whole_loops(Polygons& caps) const;
    std::size_t next_edge(const DirectedEdge& arriving, const std::vector<bool>& taken) const;
    bool find_parts(std::span<const PieceRef> refs, CellCut& result);
    bool use_edges_twice(const std::vector<std::int32_t>& root, std::int32_t pieces);
    void attach_hollows(std::span<const PieceRef> refs, const CellCut& result,
                        DisjointSets& sets) const;
    std::int8_t side_of(std::size_t local, std::span<const PieceRef> refs) const;
    void add_uses_of_caps(const Polygons& caps, std::int32_t pieces);
    void join_at_edge(std::span<const Use> uses, std::int8_t side, std::int32_t pieces,
                      DisjointSets& sets);

    const ComplexView& model_;
    const std::vector<std::int8_t>& sides_;
    const EdgeIntersections& cuts_;
    const CutPieces& pieces_;
    PlanePoints points_;

    std::vector<Use> uses_;
    std::vector<const Use*> faces_at_edge_;
    std::vector<DirectedEdge> open_;
    std::vector<std::array<NodeId, 2>> slits_, dissolved_;
    std::vector<Loop> loops_;
    bool whole_loops_ = false;
    PlanePosition rounding_{0, 0};
};

}  // namespace realmodel::cutting
