// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace realmodel {
class Progress;
}

namespace realmodel::meshing {

/// A place in plan (x, y), model units.
using PlanPoint = std::array<double, 2>;

/// Corners of a closed outline or hole, either way round; the first corner is not repeated at the
/// end.
using Ring = std::vector<PlanPoint>;

/// A triangulated part of the plan; triangles counter-clockwise.
struct PlanarMesh {
    std::vector<PlanPoint> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

/// An edge of a triangulation, the lesser end first, that a segment runs along.
struct CoveredEdge {
    std::int32_t from, to, segment;
    auto operator<=>(const CoveredEdge&) const = default;
};

/// A constrained Delaunay triangulation of given points; edge i of a triangle goes from its corner
/// i to its corner (i + 1) % 3.
struct ConstrainedTriangulation {
    std::vector<std::array<std::int32_t, 3>>
        triangles;  ///< point numbers, counter-clockwise, least first
    std::vector<std::array<std::int32_t, 3>>
        neighbors;                                 ///< triangle across edge i, -1 outside the hull
    std::vector<std::array<bool, 3>> constrained;  ///< edge i lies on a segment
    /// The edges that each segment consists of, sorted: one that comes twice belongs to two.
    std::vector<CoveredEdge> covered;
};

/// Triangulates the convex hull of `points` so that every segment is a chain of edges, and every
/// other edge is Delaunay as far as the segments allow (Chew 1989, "Constrained Delaunay
/// triangulations"; exact predicates; no vertex is ever made).
///
/// Points are distinct. Segments (pairs of point numbers) may touch, pass through points and
/// overlap; two that cross where there is no point are refused. No triangles if all points are in
/// one line. The order of the result depends on the numbers of the points alone.
///
/// @throws InputError of kind "crossing" (items: the two segments; place), "repeated_point" (items:
/// the two points), "not_finite" (items: the point), "bad_index" (items: the segment); Cancelled.
ConstrainedTriangulation constrained_delaunay(std::span<const PlanPoint> points,
                                              std::span<const std::array<std::int32_t, 2>> segments,
                                              const Progress* progress = nullptr);

/// Triangulates what lies inside an odd number of rings (outlines, holes, islands in holes alike)
/// without adding a vertex. Vertices: the distinct corners in order of appearance. Rings may touch
/// in points, themselves too. @throws InputError as triangulate_region does (see rings.hpp);
/// Cancelled.
PlanarMesh triangulate_rings(std::span<const Ring> rings, Progress* progress = nullptr);

}  // namespace realmodel::meshing
