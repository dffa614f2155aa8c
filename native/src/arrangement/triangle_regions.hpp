// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "arrangement/polygons.hpp"
#include "exact/space_points.hpp"

namespace realmodel::arrangement {

using exact::SpacePointId;

/// How a triangle is seen: along which axis, and which way it turns then (1 left, -1 right).
struct Projection {
    std::size_t axis;
    int facing;
};

/// An outline that turns left in the view, and the holes in it.
using RegionLoops = std::vector<std::vector<SpacePointId>>;

/// The bounded faces of a plane graph. Edges must be (lesser, greater) node, sorted, each once,
/// and meet at nodes only.
/// @return the faces in the order of their first half-edge; holes in that of their nodes
std::vector<RegionLoops> regions_of_graph(const exact::SpacePoints& points, const Projection& view,
                                          const std::vector<std::array<SpacePointId, 2>>& edges);

}  // namespace realmodel::arrangement
