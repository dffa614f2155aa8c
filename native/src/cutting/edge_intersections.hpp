// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "cutting/polygons.hpp"
#include "exact/oriented_plane.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

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

}  // namespace realmodel::cutting
