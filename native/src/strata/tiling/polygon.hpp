// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "exact/local_arrangement.hpp"
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

/// Copies the corners of a polygon to other memory, those of triangles and of most pieces by a few
/// instructions: a call for each costs more than its corners.
inline void copy_corners(PolygonView from, Corner* to) {
    const auto copy_two = [&](std::size_t at) {
        std::memcpy(to + at, from.data() + at, 2 * sizeof(Corner));
    };
    const std::size_t count = from.size();
    if (count < 2 || count > 8) {
        std::copy(from.begin(), from.end(), to);
    } else {  // what is copied twice is the same
        copy_two(0);
        if (count > 4) {
            copy_two(2);
            copy_two(count - 4);
        }
        copy_two(count - 2);
    }
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
        const std::size_t before = corners.size();
        corners.resize(before + polygon.size());
        copy_corners(polygon, corners.begin() + before);
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

/// The part of a convex polygon to the left of a line; empty where it has no area.
/// `sides` is scratch; `result` must not be `polygon`.
void clip(LocalArrangement& scope, PolygonView polygon, DirectedLine line, std::vector<int>& sides,
          Polygon& result);

/// Appends what lies to the left of a line of a convex polygon's corners (a Corner, or what has one
/// as its base), whose sides are known; crossings with the line are new corners.
template <class Corners, class Result>
void keep_left(LocalArrangement& scope, const Corners& corners, DirectedLine line,
               const std::vector<int>& sides, Result& result) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const int here = sides[i], there = sides[i + 1 < corners.size() ? i + 1 : 0];
        const auto& corner = corners[i];
        if (here >= 0) {
            result.push_back(corner);
            if (here == 0 && there < 0) result.back().line = line;
        }
        if (here * there < 0) {
            const PointId at = scope.crossing(corner.line.id(), line.id());
            const DirectedLine leaving = here > 0 ? line : corner.line;
            auto& made = result.emplace_back();
            made.point = at;
            made.line = leaving;
        }
    }
}

/// Clips by every edge of a convex polygon in turn.
class Clipper {
public:
    explicit Clipper(LocalArrangement& scope) : scope_(scope) {}

    /// The common part of two convex polygons, valid until the next call; empty without area.
    PolygonView intersect(PolygonView subject, PolygonView window);
    /// The part of a polygon to the left of a line, valid until the next call.
    PolygonView cut(PolygonView subject, DirectedLine line);
    /// Whether two convex polygons share an area; makes no points.
    bool overlap(PolygonView a, PolygonView b);

private:
    bool separated(PolygonView a, PolygonView b);

    LocalArrangement& scope_;
    std::vector<int> sides_;
    Polygon current_, next_;
};

}  // namespace realmodel::strata
