// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <cstdint>
#include <vector>

#include "cutting/polygons.hpp"
#include "exact/double_double_interval.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {

inline constexpr std::int8_t kAbove = 1, kOn = 0, kBelow = -1;

/// Signed distances from a plane, times the length of its normal.
class PlaneDistance {
public:
    /// @throws InputError kinds not_finite, bad_plane
    explicit PlaneDistance(const Plane& plane);

    /// kAbove, kBelow, or kOn where the distance is exactly zero.
    std::int8_t side(const Position& p) const;
    /// How far rounding may put a position from the plane.
    double rounding(const Position& p) const;
    /// Whether the plane passes within half a unit in the last place of one of its coordinates.
    bool is_beside(const Position& p) const;
    exact::DoubleDoubleInterval at(const Position& p) const;
    mpq_class exact(const Position& p) const;
    /// The doubles nearest to where the line from p to q, which lie on different sides, passes
    /// through the plane.
    Position crossing(const Position& p, const Position& q) const;
    const Position& normal() const { return normal_; }

private:
    Position point_, normal_;
};

/// The side of every vertex.
std::vector<std::int8_t> vertex_sides(const ComplexView& model, const PlaneDistance& distance,
                                      int threads, const Progress* progress);

/// The places where edges pass through the plane, each a node beside the model's vertices.
class Crossings {
public:
    /// Edges as (lesser, greater) vertex; sorts them and computes their places, rounded once.
    Crossings(const ComplexView& model, const PlaneDistance& distance,
              std::vector<std::array<NodeId, 2>> edges);

    std::size_t size() const { return edges_.size(); }
    NodeId first_node() const { return first_; }
    NodeId node(NodeId a, NodeId b) const;
    bool is_crossing(NodeId node) const { return node >= first_; }
    const std::array<NodeId, 2>& edge(std::size_t i) const { return edges_[i]; }
    Position& position(std::size_t i) { return positions_[i]; }
    const Position& position(std::size_t i) const { return positions_[i]; }

private:
    NodeId first_;
    std::vector<std::array<NodeId, 2>> edges_;
    std::vector<Position> positions_;
};

}  // namespace realmodel::cutting
