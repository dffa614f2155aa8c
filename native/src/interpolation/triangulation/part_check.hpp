// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/triangulation/point_triangulation.hpp"
#include "realmodel/interpolation/convex_hull.hpp"
#include "realmodel/interpolation/triangulated.hpp"

namespace realmodel::interpolation {

/// Tells of circles whether a part of some points has all points that may lie in them. Positions
/// are local coordinates.
class PartCheck {
public:
    PartCheck(const DataPoints& data, const PointsAround& around);

    /// Whether a node lies in the hull of all points, its border included. Exact.
    bool in_hull(const Position& node) const { return hull_.contains(node); }
    const HullBorder& border() const { return border_; }
    /// Whether the part is the whole.
    bool is_whole() const { return is_whole_; }

    /// Whether two points are next to each other on the border of the hull.
    bool is_hull_edge(const Position& a, const Position& b) const;

    /// Whether the part has all points in the circle through p and two points, or, of an edge of
    /// the hull, on the side of the edge where p is.
    bool has_all_in_circle(const Position& p, const Position& a, const Position& b) const;

private:
    bool has_all_in(const spatial::PlanBox& box) const;

    ConvexHull hull_;
    HullBorder border_;
    std::vector<std::pair<Position, std::size_t>> place_on_border_;  // ascending
    spatial::PlanBox all_, window_;
    bool is_whole_;
};

}  // namespace realmodel::interpolation
