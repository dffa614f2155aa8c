// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/edge_fan.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "cutting/pieces.hpp"
#include "exact/oriented_plane.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

using arrangement::EdgeUse;

/// @throws InputError kinds not_finite, bad_plane
exact::OrientedPlane checked_plane(const Plane& plane);

/// The side of every vertex.
std::vector<std::int8_t> vertex_sides(const ComplexView& model, const exact::OrientedPlane& plane,
                                      const Execution& execution);

/// The points where edges pass through the plane, each a node after the model's vertices.
class EdgeIntersections {
public:
    /// Edges as (lesser, greater) vertex; sorts them and computes their points, rounded once.
    /// @throws InputError kind too_large
    EdgeIntersections(const ComplexView& model, const exact::OrientedPlane& plane,
                      std::vector<std::array<NodeId, 2>> edges);

    std::size_t size() const { return edges_.size(); }
    NodeId first_node() const { return first_; }
    NodeId node(NodeId a, NodeId b) const;
    bool contains(NodeId node) const { return node >= first_; }
    const std::array<NodeId, 2>& edge(NodeId node) const { return edges_[index(node - first_)]; }
    const Position& position(NodeId node) const { return positions_[index(node - first_)]; }
    const std::vector<Position>& positions() const { return positions_; }

private:
    NodeId first_;
    std::vector<std::array<NodeId, 2>> edges_;
    std::vector<Position> positions_;
};

/// Orientations of nodes of a plane cut where they are exactly: the model's vertices, and the
/// points where the plane cuts its edges, whose coordinates are rational numbers.
class PlanePoints : public CornerTurns {
public:
    PlanePoints(const ComplexView& model, const exact::OrientedPlane& plane,
                const EdgeIntersections& cuts)
        : model_(model), plane_(plane), cuts_(cuts), view_(plane.normal()) {}

    const View& view() const { return view_; }
    Position rounded(NodeId node) const {
        return cuts_.contains(node) ? cuts_.position(node) : model_.vertex(node);
    }
    /// Which way a, b, c turn in the view.
    int operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const override;
    /// Which side of the plane of a, b, c has d: exact::orient3d.
    int tetrahedron(NodeId a, NodeId b, NodeId c, NodeId d) const;

private:
    exact::RationalPoint exact_point(NodeId node) const;
    double inexactness(NodeId node) const;

    const ComplexView& model_;
    const exact::OrientedPlane& plane_;
    const EdgeIntersections& cuts_;
    View view_;
};

/// Parts of one face, each on one side of the plane.
struct SplitFace {
    Polygons polygons;  ///< turning as the face does
    std::vector<std::int8_t> sides;

    void clear() {
        polygons.clear();
        sides.clear();
    }
};

/// Divides faces that have corners on both sides of a plane.
///
/// Most faces change sides twice: the line between the two points divides them. Others (walls need
/// not be convex) are divided as their triangulation is, and the parts of the triangles joined
/// again: which points a cut joins follows from the triangles alone, so that the parts fit together
/// whatever rounding did to the face.
class FaceSplitter {
public:
    FaceSplitter(const ComplexView& model, const std::vector<std::int8_t>& sides,
                 const EdgeIntersections& cuts)
        : model_(model), sides_(sides), cuts_(cuts) {}

    void split(std::span<const NodeId> face, SplitFace& split);

private:
    struct TrianglePiece;
    class Cuts;

    void split_triangle(const std::array<LoopCorner, 3>& t, const Cuts& cuts,
                        std::vector<TrianglePiece>& pieces) const;
    bool split_in_two(std::span<const NodeId> face, SplitFace& split);
    void split_by_triangles(std::span<const NodeId> face, SplitFace& split);
    std::int8_t side(NodeId v) const { return sides_[index(v)]; }

    const ComplexView& model_;
    const std::vector<std::int8_t>& sides_;
    const EdgeIntersections& cuts_;
    std::vector<NodeId> cycle_;
};

/// How a plane divides one cell.
struct CellCut {
    Polygons cut_faces;    ///< counter-clockwise seen from above
    bool is_clean = true;  ///< false: what bounds them crosses itself, or runs back along itself
    /// The part of the cell that each of its pieces belongs to, then, cut face after cut face, the
    /// part below it and the part above it. Parts are counted in the order of their first piece.
    std::vector<std::int32_t> part;
    std::vector<std::int8_t> part_side;
};

/// Closes the parts of cells where a plane has cut them.
///
/// The edges in the plane that the pieces above it leave open bound the cut faces. Along an edge of
/// the cell that only touches the plane nothing is open; whether the cut faces pass on both of its
/// sides or on neither follows from which of the two faces there is steeper.
class CellCutter {
public:
    CellCutter(const ComplexView& model, const std::vector<std::int8_t>& sides,
               const EdgeIntersections& cuts, const CutPieces& pieces,
               const exact::OrientedPlane& plane)
        : model_(model), sides_(sides), cuts_(cuts), pieces_(pieces), points_(model, plane, cuts) {}

    /// The cut faces alone.
    void cut_face(std::span<const PieceRef> refs, CellCut& result);
    /// Cut faces and parts.
    void cut(std::span<const PieceRef> refs, CellCut& result);

private:
    struct CutFaceEdge {
        NodeId from, to;
    };

    LoopCorner corner(NodeId node) const { return {node, points_.view()(points_.rounded(node))}; }
    bool in_plane(NodeId node) const { return cuts_.contains(node) || sides_[index(node)] == kOn; }
    bool in_plane(const std::array<NodeId, 2>& edge) const {
        return in_plane(edge[0]) && in_plane(edge[1]);
    }
    void collect_uses(std::span<const PieceRef> refs, bool in_plane_only);
    void close(std::span<const PieceRef> refs, CellCut& result);
    void collect_open_edges(std::span<const PieceRef> refs);
    bool has_cut_faces_on_both_sides(std::span<const EdgeUse> uses,
                                     std::span<const PieceRef> refs) const;
    bool is_in_cut_faces(const std::array<NodeId, 2>& edge) const;
    void keep_slits_in_cut_faces();
    NodeId far_node(const EdgeUse& use, std::span<const PieceRef> refs) const;
    void trace_loops();
    void take_whole_loops(Polygons& cut_faces) const;
    std::size_t next_edge(const CutFaceEdge& arriving, const std::vector<bool>& taken) const;
    bool find_parts(std::span<const PieceRef> refs, CellCut& result);
    bool use_edges_twice(const std::vector<std::int32_t>& root, std::int32_t pieces);
    void attach_hollows(std::span<const PieceRef> refs, const CellCut& result,
                        DisjointSets& sets) const;
    std::int8_t side_of(std::int32_t item) const;
    void add_uses_of_cut_faces(const Polygons& cut_faces, std::int32_t pieces);
    void join_at_edge(std::span<const EdgeUse> uses, std::int8_t side, DisjointSets& sets);

    const ComplexView& model_;
    const std::vector<std::int8_t>& sides_;
    const EdgeIntersections& cuts_;
    const CutPieces& pieces_;
    PlanePoints points_;

    /// Edges in the order of their nodes, as the cell sees them; items are numbers among its
    /// pieces, then two for each cut face.
    std::vector<EdgeUse> uses_;
    std::vector<std::int8_t> piece_side_;
    std::vector<const EdgeUse*> faces_at_edge_;
    std::vector<CutFaceEdge> open_;
    std::vector<std::array<NodeId, 2>> slits_, dissolved_;
    std::vector<Loop> loops_;
    bool whole_loops_ = false;
    PlanePosition rounding_{0, 0};
};

}  // namespace realmodel::cutting
