// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "arrangement/polygons.hpp"
#include "exact/space_points.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::arrangement {

using exact::SpacePointId;

// Notation of what divides triangles; that of cells of space is in space_cells.hpp.
//
//   point     a point of space with exact coordinates (exact/space_points.hpp)
//   facing    which way a triangle turns seen along its axis, along which it is seen best: 1 left,
//             -1 right, 0 it has no area
//   segment   what two triangles that cross have in common: on the line of both planes, from where
//             one of them passes the other's plane from below (up) or back (down) to the next such
//             end (SegmentEnd); or where an edge of one runs over the other in their common plane
//   line      of a triangle: one of its segments, or one of its edges
//   node      a corner of a triangle, an end of its segments, or where these cross
//   edge      a part of a line between two nodes that follow one another on it
//   half-edge an edge in one of its directions (PlaneGraph); its twin is the other one. Its next is
//             the half-edge with which the region to its left goes on
//   loop      half-edges that follow one another and close: an outline turns as its triangle does,
//             a hole the other way round
//   region    what an outline and the holes in it bound: nothing crosses it. The regions of a
//             triangle tile it: each edge within has one region on either side

/// A part of a triangle that nothing crosses. The outline turns as the triangle does, holes follow
/// the other way round.
struct Region {
    std::int32_t triangle;
    Loops<SpacePointId> loops;
};

/// The regions of triangles, in the order of these.
struct Regions {
    Array<std::int32_t> triangles;
    LoopTable<SpacePointId> loops;

    std::size_t size() const { return triangles.size(); }
    Region operator[](std::size_t region) const { return {triangles[region], loops[region]}; }
};

/// Triangles in any position, divided exactly where they cross each other: every region's edges are
/// edges of all regions that meet there, and every point of one triangle on another is a node of
/// both. Pairs that are not asked for are taken not to cross, but on triangles that both intersect.
class TriangleArrangement {
public:
    explicit TriangleArrangement(exact::SpacePoints& points) : points_(points) {}

    /// The number of the triangle. One without area stays an edge that others share.
    /// @throws InputError kind too_large
    std::int32_t add(const std::array<SpacePointId, 3>& corners);
    /// The same for many, numbered in their order.
    void add_all(std::span<const std::array<SpacePointId, 3>> corners, const Execution& execution);

    /// An end of a segment on the line of two planes: a corner, or where an edge of one triangle
    /// passes through the plane of the other.
    struct SegmentEnd {
        SpacePointId from;        ///< the corner, or the end of the edge below the plane
        SpacePointId to = kNone;  ///< the other end, none of a corner
        std::int32_t plane = 0;   ///< of which triangle
    };
    /// Where two triangles intersect: along a segment, in a point (two equal ends), or in one
    /// plane.
    struct TriangleIntersection {
        std::int32_t one, other;
        bool in_one_plane;
        std::array<SegmentEnd, 2> ends;
    };
    /// Where two triangles intersect beside the corners and edges that they share. May be asked by
    /// several threads at once.
    std::optional<TriangleIntersection> intersection(std::int32_t one, std::int32_t other) const;
    /// The point that an end is.
    SpacePointId point_of(const SegmentEnd& end);
    /// Adds its points and its segment to both triangles.
    void insert(const TriangleIntersection& intersection);
    /// Adds a line between two points within a triangle, of something that needs no triangle of its
    /// own.
    /// @return its number, from 0 on
    std::int32_t add_line(std::int32_t triangle, SpacePointId p, SpacePointId q);
    /// Once all is divided, the nodes between the ends of such a line, from the lesser to the
    /// greater.
    std::span<const SpacePointId> within_line(std::int32_t line) const {
        return within_lines_[index(line)];
    }
    /// Divides all triangles. With it no more can be added.
    void divide(const Execution& execution);

    const Regions& regions() const { return regions_; }
    const std::array<SpacePointId, 3>& corners(std::int32_t triangle) const {
        return triangles_[index(triangle)].corners;
    }
    /// The axis along which a triangle is seen best, and which way it turns: 0 it has no area.
    std::pair<std::size_t, int> view_of(std::int32_t triangle) const {
        return {triangles_[index(triangle)].axis, triangles_[index(triangle)].facing};
    }
    /// A corner of a triangle to the left of a line in it.
    SpacePointId left_corner(std::int32_t triangle, SpacePointId from, SpacePointId to) const;

private:
    struct SharedSegment {
        std::array<SpacePointId, 2> ends;  ///< in order
        std::int32_t other;                ///< the triangle that it is shared with; -1 - a line
        auto operator<=>(const SharedSegment&) const = default;
    };
    struct ArrangedTriangle {
        std::array<SpacePointId, 3> corners;
        std::size_t axis = 0;
        int facing = 0;                    ///< which way it turns seen along its axis, 0: no area
        std::vector<SpacePointId> points;  ///< in order, once all are there
        std::vector<SharedSegment> segments;  ///< likewise
        /// Its segments, then its edges.
        std::size_t line_count() const { return segments.size() + 3; }
        std::array<SpacePointId, 2> line(std::size_t i) const {
            if (i < segments.size()) return segments[i].ends;
            return {corners[i - segments.size()], corners[(i - segments.size() + 1) % 3]};
        }
    };
    /// On which sides of the plane of another triangle corners lie.
    struct CornerSides {
        std::array<int, 3> of;
        int above = 0, below = 0;
    };
    /// What a triangle has of the line of its plane and another's. It passes that other plane from
    /// below at `up`, and back at `down`; both are one where only a corner touches it.
    struct LineInterval {
        SegmentEnd up, down;
    };
    /// A point of one triangle that is also on another.
    struct Message {
        std::int32_t to;
        SpacePointId point;
    };
    /// The ends of one segment, then those of another.
    using SegmentPair = std::array<SpacePointId, 4>;
    using SpaceEdge = std::array<SpacePointId, 2>;
    class NodesOnLines;
    struct LineRange;
    struct BoxedSegments;

    ArrangedTriangle triangle_of(const std::array<SpacePointId, 3>& corners) const;
    int orientation(const ArrangedTriangle& t, SpacePointId a, SpacePointId b,
                    SpacePointId c) const {
        return t.facing * exact::orient2d(points_, t.axis, a, b, c);
    }
    CornerSides sides_of(const ArrangedTriangle& t, const ArrangedTriangle& plane) const;
    bool are_folded_apart(const ArrangedTriangle& a, const ArrangedTriangle& b) const;
    static LineInterval interval_of(const ArrangedTriangle& t, const CornerSides& sides,
                                    std::int32_t plane);
    int order(const ArrangedTriangle& a, const CornerSides& sides, const SegmentEnd& on_a,
              const ArrangedTriangle& b, const SegmentEnd& on_b) const;
    void add_segment(std::int32_t one, std::int32_t other, SpacePointId p, SpacePointId q);
    bool passes_by(const ArrangedTriangle& t, SpacePointId p, SpacePointId q) const;
    void clip_edges(std::int32_t edges_of, std::int32_t into);
    void clip_segment(SpacePointId p, SpacePointId q, std::int32_t of, std::int32_t into);
    void exchange_segments();
    std::vector<std::int32_t> all_triangles() const;
    template <class Count>
    static std::vector<std::vector<LineRange>> line_chunks(std::span<const std::int32_t> among,
                                                           const Count& count);
    template <class Prepared, class Visit>
    void for_each_range(const std::vector<std::vector<LineRange>>& chunks,
                        const Execution& execution, const Visit& visit) const;
    void sort_all(const Execution& execution);
    bool do_cross(const ArrangedTriangle& t, const SegmentPair& pair) const;
    void intersect_segments(const Execution& execution);
    std::vector<std::vector<SpaceEdge>> exchange_points(const Execution& execution);
    void messages_of(const LineRange& range, const NodesOnLines& nodes_on,
                     std::vector<Message>& messages, std::vector<SpaceEdge>& edges);
    class RegionFinder;
    void find_all_regions(std::vector<std::vector<SpaceEdge>>& edges, const Execution& execution);

    exact::SpacePoints& points_;
    std::vector<ArrangedTriangle> triangles_;
    /// The edges of all triangles, in order, with the triangle of each.
    std::vector<std::pair<std::array<SpacePointId, 2>, std::int32_t>> of_edge_;
    Regions regions_;
    std::vector<std::array<std::int32_t, 2>> in_one_plane_;
    std::vector<std::vector<SpacePointId>> within_lines_;
};

}  // namespace realmodel::arrangement
