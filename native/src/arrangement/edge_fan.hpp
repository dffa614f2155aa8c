// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "arrangement/polygons.hpp"
#include "exact/space_points.hpp"

namespace realmodel::arrangement {

/// A polygon seen along one of its edges.
struct EdgeUse {
    std::array<NodeId, 2> edge;  ///< lesser, greater
    std::int32_t item;           ///< region, or face after all regions
    std::int8_t direction;       ///< 1 from lesser to greater, -1 back
    auto operator<=>(const EdgeUse&) const = default;

    /// The side of the item that is ahead of it for one who goes round the edge, 0 or 1; the other
    /// one is behind it. Side 0 is the one that the item does not turn counter-clockwise for.
    std::size_t ahead() const { return direction > 0 ? 0 : 1; }
    std::size_t behind() const { return 1 - ahead(); }
};

/// Calls visit(use) for all edges of some loops.
template <class Loops, class Visit>
void each_edge(const Loops& loops, std::int32_t item, const Visit& visit) {
    for (const auto& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
            visit(EdgeUse{unordered(a, b), item, static_cast<std::int8_t>(a < b ? 1 : -1)});
        }
    }
}

/// Half of a plane that begins at an edge.
struct HalfPlane {
    exact::SpacePointId towards;  ///< a point of it, not on the line of the edge
    std::int32_t plane;           ///< two of the same number, if it is not -1, lie in one plane
    std::int8_t direction;        ///< 1 or -1: two of the same plane and direction are the same
};

/// Half-planes around one edge in counter-clockwise order for one who looks along it, beginning
/// with the first. Those that are the same make one blade.
struct EdgeFan {
    std::vector<std::size_t> order;            ///< numbers of half-planes
    std::vector<std::size_t> blade_begins{0};  ///< in `order`, and its end

    std::size_t blades() const { return blade_begins.size() - 1; }
    std::span<const std::size_t> blade(std::size_t i) const {
        return {order.data() + blade_begins[i], blade_begins[i + 1] - blade_begins[i]};
    }
};

/// The fan around the edge from a to b.
EdgeFan fan_around(const exact::SpacePoints& points, exact::SpacePointId a, exact::SpacePointId b,
                   std::span<const HalfPlane> items);
/// The same in a fan that was another before, whose memory it takes.
void find_fan(const exact::SpacePoints& points, exact::SpacePointId a, exact::SpacePointId b,
              std::span<const HalfPlane> items, EdgeFan& fan);

}  // namespace realmodel::arrangement
