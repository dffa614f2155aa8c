// SPDX-License-Identifier: GPL-3.0-or-later
// Edges of a region cut at points, however close others come: its border, and the lines inside.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/region_graph.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// An edge and the points that are to cut it, in order from its first end.
struct CutEdge {
    VertexSegment edge;
    std::int32_t first, last;  ///< numbers of the points, one after another
};

/// Doubles do not hold most points of an edge: what is added on it bends it, by `slack` at most.
double rounding_slack(std::span<const PlanPoint> points);

/// Whether an edge may be bent by `slack` towards the triangle that a half-edge is in, at points no
/// nearer to its ends than `nearest`, without meeting the two other edges, be they bent as well.
bool has_room(const FlatMesh& mesh, HalfEdge edge, double nearest, double slack);

/// Whether an edge can be cut at a point near it without turning a triangle over. Exact.
bool can_cut(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p);

/// A triangulation of all of a region's points, of the inside and what is around it, whose fixed
/// edges are cut at one point after the other. Every step leaves all triangles exactly
/// counter-clockwise, so that nothing ever crosses; a point that there is no room for is left out.
class EdgeCutting {
public:
    /// `inside` tells of each triangle whether it belongs to the region. The points may be more
    /// than those of the triangles.
    EdgeCutting(const ConstrainedTriangulation& triangulation, const std::vector<bool>& inside,
                std::vector<PlanPoint> points);

    /// Appends what a longer list of points has more.
    void add_points(std::span<const PlanPoint> points);
    /// Cuts edges of the triangulation, all of them first where there are most points on either
    /// side, so that the work is n log n at worst. Where a point has no room its neighbors among
    /// the doubles are tried.
    void cut(std::span<const CutEdge> edges, const Check& check);
    /// Whether a point has become a vertex.
    bool has(std::int32_t point) const { return !at_[point].is_none(); }

    /// The edge between two vertices, in either direction; none if there is none.
    HalfEdge between(std::int32_t a, std::int32_t b) const;
    bool is_inside(HalfEdge edge) const { return inside_[edge.triangle()]; }
    const FlatMesh& mesh() const { return mesh_; }
    /// The triangles inside. Edges of their border are locked where there is no room outside for
    /// cuts farther than `nearest` from their ends.
    FlatMesh take_inside(double nearest, double slack) &&;

private:
    bool insert(HalfEdge edge, std::int32_t point);

    FlatMesh mesh_;
    std::vector<bool> inside_;
    std::vector<HalfEdge> at_;  ///< of each vertex: a half-edge from it
};

/// First the points of the graph as they are, then points added on its edges, each rounded once.
/// Pieces cross nowhere: a point is left out, and used by no piece, where rounding would put it
/// beyond another edge.
struct BorderPieces {
    std::vector<PlanPoint> points;
    std::vector<VertexSegment> border;  ///< the region on their left
    std::vector<VertexSegment> inner;
    std::vector<CutEdge> edges;         ///< of the graph, border and inner, with what cuts them
    std::vector<VertexSegment> locked;  ///< of the border: too close to others outside of the
                                        ///< region to be cut again; sorted
};

/// Cuts every edge into pieces that are equal as measured by the length wanted where they are, at
/// most 1.4 of it. Around a corner sharper than 60 degrees all edges are first cut at one distance
/// from it, so that the triangle at the tip has two equal edges (Ruppert 1995, section 7, "corner
/// lopping" by concentric circles). `finest`: pieces half as long will not be cut again.
BorderPieces cut_border(const RegionGraph& graph, SizeField& size, double finest,
                        const Check& check);

/// Cuts every edge where it crosses the lines of a grid of squares, but for cuts nearer than
/// `closest` (sides of a square) to an end or to the cut before.
BorderPieces cut_border_by_grid(const RegionGraph& graph, const PlanPoint& origin, double spacing,
                                double closest, double finest, const Check& check);

/// About how many pieces cut_border makes for one length everywhere; cheap, for estimates.
double estimate_pieces(const RegionGraph& graph, double edge_length);

}  // namespace realmodel::meshing
