// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "exact/local_arrangement.hpp"
#include "exact/reach_filter.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel::strata {

using exact::DirectedLine;
using exact::LineId;
using exact::LocalArrangement;
using exact::PlaneId;
using exact::PointId;

/// A corner of a convex plan polygon and the line of the edge that leaves it; the polygon lies to
/// the left of all its edges, and no two neighboring edges lie on one line.
struct Corner {
    PointId point;
    DirectedLine line;
};

using Polygon = std::vector<Corner>;
using PolygonView = std::span<const Corner>;

/// An edge of a polygon.
inline exact::DirectedEdge edge_of(PolygonView polygon, std::size_t i) {
    return {polygon[i].line, polygon[i].point, polygon[i + 1 < polygon.size() ? i + 1 : 0].point};
}

/// Many polygons in one array; of less than 2^32 corners, as joining chunks checks.
struct PolygonPool {
    Array<std::uint32_t> offsets{0};
    Array<Corner> corners;

    std::size_t size() const { return offsets.size() - 1; }
    PolygonView operator[](std::size_t i) const {
        return {corners.data() + offsets[i], offsets[i + 1] - offsets[i]};
    }
    void add(PolygonView polygon) {
        corners.append(polygon.begin(), polygon.end());
        offsets.push_back(static_cast<std::uint32_t>(corners.size()));
    }
};

/// Marks all lines and points of polygons as used.
inline void mark_used(LocalArrangement& scope, const PolygonPool& pool) {
    for (const Corner& corner : pool.corners) {
        scope.mark_point_used(corner.point);
        scope.mark_line_used(corner.line.id());
    }
}

/// Writes the corners of polygons with their shared lines and points, which are committed.
inline void share(LocalArrangement& scope, const PolygonPool& pool, Corner* shared) {
    for (const Corner& corner : pool.corners)
        *shared++ = {scope.shared_point(corner.point), scope.shared_directed(corner.line)};
}

/// Gives polygons the shared lines and points.
inline void share(LocalArrangement& scope, PolygonPool& pool) {
    share(scope, pool, pool.corners.begin());
}

/// The part of a convex polygon to the left of a line that crosses it.
/// @param sides  of its corners: 1 left, 0 on the line, -1 right
void keep_left(LocalArrangement& scope, PolygonView polygon, DirectedLine line,
               std::span<const std::int8_t> sides, Polygon& result);

/// Cuts one convex polygon after another with other ones. The corners of each of the two are asked
/// once about the lines of the other; where one lies on a line, more is asked about new corners.
class Clipper {
public:
    explicit Clipper(LocalArrangement& scope) : scope_(scope) {}

    /// Begins with a polygon, which has to stay where it is.
    void begin(PolygonView subject);
    /// What it has in common with another one, valid until the next call; empty without area. It
    /// begins with the first of the subject's edges that it has a part of, or with the window's
    /// first corner where it has none.
    PolygonView intersect(PolygonView window);
    /// Whether the two share an area; makes no points.
    bool overlaps(PolygonView window);

private:
    using SidesOfCorners = std::vector<std::int8_t>;
    /// Known corners are looked up in the slot that their number gives; who comes last stays.
    static constexpr std::size_t kKnown = 64;
    struct KnownCorner {
        PointId point = kNone;
        std::uint32_t subject = 0;   ///< of whose edges this is known
        std::size_t first_side = 0;  ///< in `known_sides_`
    };
    /// Of corner j of the window, for each edge of the subject.
    std::span<const std::int8_t> window_sides(std::size_t j) const {
        return {known_sides_.data() + window_corners_[j], subject_.size()};
    }
    void follow(PolygonView window);
    void cut_by_lines(PolygonView window);
    void rotate(PolygonView window);

    LocalArrangement& scope_;
    PolygonView subject_;
    std::uint32_t number_ = 0;                      ///< of the subject
    std::vector<exact::ReachFilter> filters_;       ///< of its edges
    std::vector<std::array<double, 2>> positions_;  ///< of its corners
    SidesOfCorners subject_sides_;                  ///< of these, for each edge of the window
    std::array<KnownCorner, kKnown> known_;
    SidesOfCorners known_sides_;
    std::vector<std::size_t> window_corners_;  ///< their first sides
    SidesOfCorners sides_;                     ///< of what is left
    Polygon result_, next_;
};

}  // namespace realmodel::strata
