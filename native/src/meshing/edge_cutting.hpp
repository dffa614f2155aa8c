// SPDX-License-Identifier: GPL-3.0-or-later
// Points added on the edges of a region, however close others come.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"

namespace realmodel::meshing {

/// An edge and the points that are to cut it, in order from its first end.
struct CutEdge {
    Segment edge;
    std::int32_t first, last;  ///< numbers of the points, one after another
};

/// Doubles do not hold most points of an edge: what is added on it bends it, by `slack` at most.
double rounding_slack(std::span<const PlanPoint> points);

/// Whether an edge may be bent by `slack` towards the triangle that a half-edge is in, at points no
/// nearer to its ends than `nearest`, without meeting the two other edges, be they bent as well.
bool has_room(const FlatMesh& mesh, HalfEdge edge, double nearest, double slack);

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

}  // namespace realmodel::meshing
