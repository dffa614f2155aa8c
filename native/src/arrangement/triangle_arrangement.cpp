// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles, and where they intersect.
#include "arrangement/triangle_arrangement.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel.hpp"

namespace realmodel::arrangement {

using exact::orient3d;

TriangleArrangement::ArrangedTriangle TriangleArrangement::triangle_of(
    const std::array<SpacePointId, 3>& corners) const {
    ArrangedTriangle t;
    t.corners = corners;
    const std::array<Position, 3> at{points_.rounded(corners[0]), points_.rounded(corners[1]),
                                     points_.rounded(corners[2])};
    const Position normal = polygon_normal(at);
    std::array<std::size_t, 3> axes{0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&normal](std::size_t a, std::size_t b) {
        return std::abs(normal[a]) > std::abs(normal[b]);
    });
    for (const std::size_t axis : axes) {
        t.axis = axis;
        t.facing = exact::orient2d(points_, axis, corners[0], corners[1], corners[2]);
        if (t.facing != 0) break;
    }
    return t;
}

std::int32_t TriangleArrangement::add(const std::array<SpacePointId, 3>& corners) {
    const std::int32_t number = checked_number(triangles_.size(), "triangles");
    add_all({&corners, 1}, {1, nullptr});
    return number;
}

void TriangleArrangement::add_all(std::span<const std::array<SpacePointId, 3>> corners,
                                  const Execution& execution) {
    const std::size_t before = triangles_.size();
    checked_number(before + corners.size(), "triangles");
    triangles_.resize(before + corners.size());
    of_edge_.resize(3 * triangles_.size());
    constexpr std::size_t kChunk = 1 << 10;
    parallel_ranges(
        corners.size(), kChunk, execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                triangles_[before + i] = triangle_of(corners[i]);
                for (std::size_t k = 0; k < 3; ++k) {
                    of_edge_[3 * (before + i) + k] = {
                        unordered(corners[i][k], corners[i][(k + 1) % 3]),
                        static_cast<std::int32_t>(before + i)};
                }
            }
        },
        0.02);
}

SpacePointId TriangleArrangement::left_corner(std::int32_t triangle, SpacePointId from,
                                              SpacePointId to) const {
    const ArrangedTriangle& t = triangles_[index(triangle)];
    // first the one that is farthest to the left in doubles: where the line runs along an edge, its
    // ends are not seen to be on it before exact arithmetic
    const std::size_t k = (t.axis + 1) % 3, l = (t.axis + 2) % 3;
    const Position &a = points_.rounded(from), &b = points_.rounded(to);
    const double x = t.facing * (b[k] - a[k]), y = t.facing * (b[l] - a[l]);
    const SpacePointId farthest = std::ranges::max(t.corners, {}, [&](SpacePointId corner) {
        const Position& c = points_.rounded(corner);
        return x * c[l] - y * c[k];
    });
    if (orientation(t, from, to, farthest) > 0) return farthest;
    for (const SpacePointId corner : t.corners) {
        if (orientation(t, from, to, corner) > 0) return corner;
    }
    return t.corners[0];
}

void TriangleArrangement::add_segment(std::int32_t one, std::int32_t other, SpacePointId p,
                                      SpacePointId q) {
    for (const auto& [mine, yours] : {std::pair(one, other), std::pair(other, one)}) {
        ArrangedTriangle& t = triangles_[index(mine)];
        if (t.points.capacity() == 0) {  // what the least piece of memory holds
            t.points.reserve(6);
            t.segments.reserve(2);
        }
        t.points.push_back(p);
        if (p == q) continue;
        t.points.push_back(q);
        t.segments.push_back({unordered(p, q), yours});
    }
}

std::int32_t TriangleArrangement::add_line(std::int32_t triangle, SpacePointId p, SpacePointId q) {
    const std::int32_t number = checked_number(within_lines_.size(), "lines in triangles");
    within_lines_.emplace_back();
    ArrangedTriangle& t = triangles_[index(triangle)];
    t.points.push_back(p);
    t.points.push_back(q);
    t.segments.push_back({unordered(p, q), -1 - number});
    return number;
}

TriangleArrangement::CornerSides TriangleArrangement::sides_of(
    const ArrangedTriangle& t, const ArrangedTriangle& plane) const {
    CornerSides sides;
    const exact::SidesOfPlane side_of(points_, plane.corners);
    for (std::size_t i = 0; i < 3; ++i) {
        sides.of[i] = side_of(t.corners[i]);
        sides.above += sides.of[i] > 0;
        sides.below += sides.of[i] < 0;
    }
    return sides;
}

/// Of two triangles in one plane with two corners in common: whether neither covers a part of the
/// other.
bool TriangleArrangement::are_folded_apart(const ArrangedTriangle& a,
                                           const ArrangedTriangle& b) const {
    std::array<SpacePointId, 2> edge{}, tip{};
    std::size_t shared = 0;
    for (const SpacePointId p : a.corners) {
        const bool both = std::find(b.corners.begin(), b.corners.end(), p) != b.corners.end();
        if (both) {
            edge[shared++] = p;
        } else {
            tip[0] = p;
        }
    }
    for (const SpacePointId p : b.corners) {
        if (p != edge[0] && p != edge[1]) tip[1] = p;
    }
    return orientation(a, edge[0], edge[1], tip[0]) != orientation(a, edge[0], edge[1], tip[1]);
}

TriangleArrangement::LineInterval TriangleArrangement::interval_of(const ArrangedTriangle& t,
                                                                   const CornerSides& sides,
                                                                   std::int32_t plane) {
    assert(sides.above < 3 && sides.below < 3 && sides.above + sides.below > 0);
    LineInterval interval{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3, before = (i + 2) % 3;
        const int here = sides.of[i];
        if (here == 0) {
            const int from = sides.of[before], to = sides.of[next];
            const SegmentEnd corner{t.corners[i]};
            if (from <= 0 && to >= 0 && from != to) interval.up = corner;
            if (from >= 0 && to <= 0 && from != to) interval.down = corner;
            if (from == to) interval = {corner, corner};
        } else if (here * sides.of[next] < 0) {
            if (here < 0) {
                interval.up = {t.corners[i], t.corners[next], plane};
            } else {
                interval.down = {t.corners[next], t.corners[i], plane};
            }
        }
    }
    return interval;
}

/// Which of two ends comes first along the line of two planes, in the direction of the product of
/// a's normal and b's: 1 a's, -1 b's, 0 they coincide. `sides`: of a's corners from b's
/// plane.
int TriangleArrangement::order(const ArrangedTriangle& a, const CornerSides& sides,
                               const SegmentEnd& on_a, const ArrangedTriangle& b,
                               const SegmentEnd& on_b) const {
    if (on_a.to != kNone && on_b.to != kNone)
        return orient3d(points_, on_a.from, on_a.to, on_b.from, on_b.to);
    if (on_a.to != kNone) return orientation(a, on_a.from, on_a.to, on_b.from);
    if (on_b.to != kNone) return orientation(b, on_b.from, on_b.to, on_a.from);
    std::size_t off = 0;
    while (sides.of[off] == 0)
        ++off;
    return -sides.of[off] * orientation(a, a.corners[off], on_a.from, on_b.from);
}

std::optional<TriangleArrangement::TriangleIntersection> TriangleArrangement::intersection(
    std::int32_t one, std::int32_t other) const {
    assert(one != other);
    const ArrangedTriangle &a = triangles_[index(one)], &b = triangles_[index(other)];
    if (a.facing == 0 || b.facing == 0) return std::nullopt;
    const auto shared = std::count_if(a.corners.begin(), a.corners.end(), [&b](SpacePointId p) {
        return std::find(b.corners.begin(), b.corners.end(), p) != b.corners.end();
    });
    std::array<CornerSides, 2> sides;
    for (std::size_t which = 0; which < 2; ++which) {
        sides[which] = which == 0 ? sides_of(a, b) : sides_of(b, a);
        const auto [low, high] = std::minmax(sides[which].above, sides[which].below);
        if (high == 3 || (shared == 1 && high == 2 && low == 0)) return std::nullopt;
        if (which == 0 && high == 0) {
            if (shared == 2 && are_folded_apart(a, b)) return std::nullopt;
            return TriangleIntersection{one, other, true, {}};
        }
        if (shared >= 2) return std::nullopt;  // an edge is all that they have in common
    }
    const LineInterval of_a = interval_of(a, sides[0], other), of_b = interval_of(b, sides[1], one);
    // along the product of both normals a is passed from `up` to `down`, and b from `down` to `up`
    const auto order_of = [&](const SegmentEnd& on_a, const SegmentEnd& on_b) {
        return order(a, sides[0], on_a, b, on_b);
    };
    if (order_of(of_a.down, of_b.down) > 0 || order_of(of_a.up, of_b.up) < 0) return std::nullopt;
    const int first = order_of(of_a.up, of_b.down), last = order_of(of_a.down, of_b.up);
    // of two that coincide a corner, which has a number
    const bool from_b = first > 0 || (first == 0 && of_a.up.to != kNone);
    const bool to_b = last < 0 || (last == 0 && of_a.down.to != kNone);
    return TriangleIntersection{
        one, other, false, {from_b ? of_b.down : of_a.up, to_b ? of_b.up : of_a.down}};
}

SpacePointId TriangleArrangement::point_of(const SegmentEnd& end) {
    if (end.to == kNone) return end.from;
    const auto& plane = triangles_[index(end.plane)].corners;
    return points_.intersection(end.from, end.to, plane[0], plane[1], plane[2]);
}

void TriangleArrangement::insert(const TriangleIntersection& intersection) {
    if (intersection.in_one_plane) {
        clip_edges(intersection.one, intersection.other);
        clip_edges(intersection.other, intersection.one);
        in_one_plane_.push_back({intersection.one, intersection.other});
        return;
    }
    const SpacePointId from = point_of(intersection.ends[0]), to = point_of(intersection.ends[1]);
    add_segment(intersection.one, intersection.other, from, to);
}

/// Where the edges of one triangle run over another in its plane.
void TriangleArrangement::clip_edges(std::int32_t edges_of, std::int32_t into) {
    const auto corners = triangles_[index(edges_of)].corners;
    for (std::size_t i = 0; i < 3; ++i)
        clip_segment(corners[i], corners[(i + 1) % 3], edges_of, into);
}

/// Whether a segment in the plane of a triangle has no point of it: then a line along an edge or
/// along the segment parts them. No point has to be made to know it.
bool TriangleArrangement::passes_by(const ArrangedTriangle& t, SpacePointId p,
                                    SpacePointId q) const {
    for (std::size_t k = 0; k < 3; ++k) {
        const SpacePointId a = t.corners[k], b = t.corners[(k + 1) % 3];
        if (orientation(t, a, b, p) < 0 && orientation(t, a, b, q) < 0) return true;
    }
    const int side = orientation(t, p, q, t.corners[0]);
    return side != 0 && side == orientation(t, p, q, t.corners[1]) &&
           side == orientation(t, p, q, t.corners[2]);
}

/// Where a segment of one triangle runs over another in its plane.
void TriangleArrangement::clip_segment(SpacePointId p, SpacePointId q, std::int32_t of,
                                       std::int32_t into) {
    const ArrangedTriangle& t = triangles_[index(into)];
    if (passes_by(t, p, q)) return;
    for (std::size_t k = 0; k < 3; ++k) {
        const SpacePointId a = t.corners[k], b = t.corners[(k + 1) % 3];
        const int first = orientation(t, a, b, p), second = orientation(t, a, b, q);
        if (first < 0 && second < 0) return;
        if (first < 0 && second == 0) p = q;
        if (first == 0 && second < 0) q = p;
        if (first * second >= 0) continue;
        const SpacePointId c = points_.intersection(t.axis, p, q, a, b);
        (first < 0 ? p : q) = c;
    }
    add_segment(of, into, p, q);
}

}  // namespace realmodel::arrangement
