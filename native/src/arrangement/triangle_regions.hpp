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

/// The bounded faces of plane graphs, of one after another in the same memory.
class PlaneGraph {
public:
    explicit PlaneGraph(const exact::SpacePoints& points) : points_(points) {}

    /// Adds the faces of a graph in the order of their first half-edge, each with its outline,
    /// which turns left in the view, and the holes in it in the order of their nodes.
    /// @param edges  (lesser, greater) node, sorted, each once; they must meet at nodes only
    void add_regions(const Projection& view, const std::vector<std::array<SpacePointId, 2>>& edges,
                     LoopTable<SpacePointId>& regions);

private:
    /// Half-edges 2 i and 2 i + 1 are those of edge i.
    struct GraphHalfEdge {
        SpacePointId from, to;
        std::size_t origin;  ///< the position of `from` among the nodes
        std::int32_t next = -1, loop = -1;
    };

    static std::int32_t twin(std::int32_t h) { return h ^ 1; }
    const GraphHalfEdge& half(std::int32_t h) const { return halves_[index(h)]; }
    std::span<std::int32_t> leaving(std::size_t node) {
        return {leaving_.data() + first_leaving_[node], leaving_.data() + first_leaving_[node + 1]};
    }
    std::span<const std::int32_t> leaving(std::size_t node) const {
        return {leaving_.data() + first_leaving_[node], leaving_.data() + first_leaving_[node + 1]};
    }
    std::size_t position(SpacePointId node) const;
    int orientation(SpacePointId a, SpacePointId b, SpacePointId c) const;
    bool is_before(SpacePointId p, SpacePointId q) const;
    bool is_below(std::int32_t g, std::int32_t h) const;
    std::span<const SpacePointId> loop(std::size_t i) const {
        return {loop_nodes_.data() + loop_begins_[i], loop_nodes_.data() + loop_begins_[i + 1]};
    }

    void take(const std::vector<std::array<SpacePointId, 2>>& edges);
    void link();
    void trace_loops();
    void find_components();
    void find_holes();

    const exact::SpacePoints& points_;
    Projection view_{};
    std::vector<SpacePointId> nodes_;  ///< in order
    std::vector<GraphHalfEdge> halves_;
    std::vector<std::size_t> first_leaving_;  ///< of nodes, in `leaving_`
    std::vector<std::int32_t> leaving_;       ///< of nodes: counter-clockwise
    std::vector<SpacePointId> loop_nodes_;
    std::vector<std::size_t> loop_begins_;
    std::vector<std::uint8_t> is_reached_;  ///< of nodes
    std::vector<std::size_t> open_;         ///< nodes of which the neighbors are still to be found
    std::vector<std::size_t> leftmost_;     ///< of components: the position of their first node
    std::vector<std::int32_t> outer_;       ///< of components: the loop around them
    std::vector<std::uint8_t> is_outer_;    ///< of loops
    std::vector<std::int32_t> region_of_;   ///< of loops, -1 of outer ones
    /// Holes: the region around each, and its loop.
    std::vector<std::pair<std::int32_t, std::int32_t>> holes_;
};

}  // namespace realmodel::arrangement
