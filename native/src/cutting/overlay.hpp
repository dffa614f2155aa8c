// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "exact_points.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::cutting {

/// A part of a triangle that nothing crosses. The outline turns as the triangle does, holes follow
/// the other way round.
struct Region {
    std::int32_t triangle;
    std::vector<std::vector<NodeId>> loops;
};

/// Triangles that cross each other, divided where they do so, exactly: every region's edges are
/// edges of all regions that meet there, and every point of one triangle on another is a node of
/// both, be the position as special as it may. Pairs that are not asked for are taken not to cross,
/// but on triangles that both meet.
class Overlay {
public:
    explicit Overlay(ExactPoints& points) : points_(points) {}

    /// The number of the triangle. One without area stays an edge that others share.
    std::int32_t add(const std::array<NodeId, 3>& corners);
    /// Whether two triangles may have something in common beside corners and edges that they share.
    bool may_meet(std::int32_t one, std::int32_t other) const;
    /// Finds where two triangles meet.
    void meet(std::int32_t one, std::int32_t other);
    /// Divides all triangles. With it no more can be added.
    void divide(const Progress* progress);

    const std::vector<Region>& regions() const { return regions_; }
    const std::array<NodeId, 3>& corners(std::int32_t triangle) const {
        return triangles_[index(triangle)].corners;
    }
    /// The axis along which a triangle is seen best, and which way it turns: 0 it has no area.
    std::pair<std::size_t, int> view_of(std::int32_t triangle) const {
        return {triangles_[index(triangle)].axis, triangles_[index(triangle)].turned};
    }
    /// A corner of a triangle to the left of a line in it.
    NodeId left_corner(std::int32_t triangle, NodeId from, NodeId to) const;

private:
    struct Segment {
        std::array<NodeId, 2> ends;  ///< in order
        std::int32_t other;          ///< the triangle that it is shared with
        auto operator<=>(const Segment&) const = default;
    };
    struct Triangle {
        std::array<NodeId, 3> corners;
        std::size_t axis = 0;
        int turned = 0;  ///< which way it turns seen along its axis, 0: no area
        std::set<NodeId> points;
        std::set<Segment> segments;
        /// The points in the order of one coordinate; made when there are many, and made again
        /// when there are more.
        mutable std::vector<NodeId> in_order;
    };

    int turn(const Triangle& t, NodeId a, NodeId b, NodeId c) const {
        return t.turned * points_.turn(t.axis, a, b, c);
    }
    void share(std::int32_t one, std::int32_t other, NodeId p, NodeId q);
    void meet_in_plane(std::int32_t one, std::int32_t other);
    void clip_edges(std::int32_t edges_of, std::int32_t into);
    void clip_segment(NodeId p, NodeId q, std::int32_t of, std::int32_t into);
    void exchange_segments();
    bool on_segment(const Triangle& t, NodeId p, NodeId a, NodeId b) const;
    std::vector<NodeId> nodes_on(const Triangle& t, NodeId a, NodeId b) const;
    std::span<const NodeId> points_between(const Triangle& t, NodeId a, NodeId b) const;
    void spread_points(const Progress* progress);
    void cross_segments(std::int32_t triangle);
    void find_regions(std::int32_t triangle);

    ExactPoints& points_;
    std::vector<Triangle> triangles_;
    std::map<std::array<NodeId, 2>, std::vector<std::int32_t>> of_edge_;
    std::vector<Region> regions_;
    std::vector<std::array<std::int32_t, 2>> in_one_plane_;
};

}  // namespace realmodel::cutting
