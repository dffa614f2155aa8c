// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "exact/space_points.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::booleans {

using exact::SpacePointId;
using exact::SpacePoints;
using TriangleCorners = std::array<SpacePointId, 3>;
using SpaceEdge = std::array<SpacePointId, 2>;

inline bool has(const TriangleCorners& corners, SpacePointId p) {
    return corners[0] == p || corners[1] == p || corners[2] == p;
}

/// A triangle, and points near it that it is to get as vertices.
struct FacetPoints {
    TriangleCorners corners;
    /// Of the edge from corner k to corner k + 1: its coordinate along edge_axis() grows or falls
    /// from point to point.
    std::array<std::vector<SpacePointId>, 3> on_edges;
    std::vector<SpacePointId> within;
    std::vector<SpaceEdge>
        wanted;  ///< edges between these points that it gets where nothing crosses them
};

/// The axis along which an edge is longest: points near it are in the order of this coordinate.
std::size_t edge_axis(const SpacePoints& points, SpacePointId a, SpacePointId b);

/// The triangle in triangles of its corners and these points, turned as it is. Where points lie is
/// decided where they are moved onto the edges and into the plane of the triangle, exactly; points
/// within that fall outside or together there are left out. The same for the same triangle and
/// points, however its corners are ordered. Each piece of an edge has one triangle.
/// @throws Cancelled
std::vector<TriangleCorners> divided(const SpacePoints& points, const FacetPoints& facet,
                                     Progress* progress);

}  // namespace realmodel::booleans
