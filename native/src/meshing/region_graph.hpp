// SPDX-License-Identifier: GPL-3.0-or-later
// A region with what its mesh must contain, as points and edges.
#pragma once

#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

struct RegionGraph {
    /// The rings' corners in order of appearance, then what the constraints bring. Some of the
    /// latter may lie outside the region: no edge uses them.
    std::vector<PlanPoint> points;
    std::vector<VertexSegment>
        border;  ///< between the region and what is not, the region on the left
    std::vector<VertexSegment> inner;  ///< of constraints, inside the region
    std::vector<std::int32_t> loners;  ///< points inside that no edge ends at
    double area = 0;                   ///< of the region
    /// Of all points and edges, up to the convex hull; which triangles belong to the region, and
    /// where the edges are in it.
    ConstrainedTriangulation triangulation;
    std::vector<bool> inside;
    std::vector<HalfEdge> border_at, inner_at;
};

/// Checks rings and constraints and brings them together: constraints are cut where they meet the
/// border or one another (at crossings with a new point, rounded), and what lies outside is left
/// out. @throws InputError as mesh_region does.
RegionGraph region_graph(std::span<const Ring> rings, const Constraints& constraints,
                         Progress* progress);

}  // namespace realmodel::meshing
