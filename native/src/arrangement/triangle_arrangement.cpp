// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangle_arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "arrangement/triangle_regions.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::arrangement {

using exact::compare;
using exact::orient3d;
using spatial::Box;

namespace {

/// So many triangles are one piece of work.
constexpr std::size_t kChunk = 1 << 8;

}  // namespace

std::int32_t TriangleArrangement::add(const std::array<SpacePointId, 3>& corners) {
    const std::int32_t number = checked_number(triangles_.size(), "triangles");
    Triangle t;
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
    for (std::size_t i = 0; i < 3; ++i)
        of_edge_.push_back({unordered(corners[i], corners[(i + 1) % 3]), number});
    triangles_.push_back(std::move(t));
    return number;
}

SpacePointId TriangleArrangement::left_corner(std::int32_t triangle, SpacePointId from,
                                              SpacePointId to) const {
    const Triangle& t = triangles_[index(triangle)];
    for (const SpacePointId corner : t.corners) {
        if (orientation(t, from, to, corner) > 0) return corner;
    }
    return t.corners[0];
}

void TriangleArrangement::add_segment(std::int32_t one, std::int32_t other, SpacePointId p,
                                      SpacePointId q) {
    for (const auto& [mine, yours] : {std::pair(one, other), std::pair(other, one)}) {
        Triangle& t = triangles_[index(mine)];
        t.points.push_back(p);
        if (p == q) continue;
        t.points.push_back(q);
        t.segments.push_back({unordered(p, q), yours});
    }
}

/// Calls visit(number) for all triangles, those of a chunk one after another on one thread.
template <class Visit>
void TriangleArrangement::each_triangle(int threads, const Progress* progress,
                                        const Visit& visit) const {
    parallel_ranges(triangles_.size(), kChunk, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i)
                            visit(i);
                    });
}

TriangleArrangement::Sides TriangleArrangement::sides_of(const Triangle& own,
                                                         const Triangle& plane) const {
    Sides sides;
    for (std::size_t i = 0; i < 3; ++i) {
        sides.of[i] =
            orient3d(points_, plane.corners[0], plane.corners[1], plane.corners[2], own.corners[i]);
        sides.above += sides.of[i] > 0;
        sides.below += sides.of[i] < 0;
    }
    return sides;
}

/// Of two triangles in one plane with two corners in common: whether neither covers a part of the
/// other.
bool TriangleArrangement::are_folded_apart(const Triangle& a, const Triangle& b) const {
    std::array<SpacePointId, 2> edge{}, tip{};
    std::size_t found = 0;
    for (const SpacePointId p : a.corners) {
        const bool both = std::find(b.corners.begin(), b.corners.end(), p) != b.corners.end();
        if (both) {
            edge[found++] = p;
        } else {
            tip[0] = p;
        }
    }
    for (const SpacePointId p : b.corners) {
        if (p != edge[0] && p != edge[1]) tip[1] = p;
    }
    return orientation(a, edge[0], edge[1], tip[0]) != orientation(a, edge[0], edge[1], tip[1]);
}

TriangleArrangement::Interval TriangleArrangement::interval_of(const Triangle& own,
                                                               const Sides& sides,
                                                               std::int32_t plane) {
    Interval interval{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3, before = (i + 2) % 3;
        const int here = sides.of[i];
        if (here == 0) {
            const int from = sides.of[before], to = sides.of[next];
            const End corner{own.corners[i]};
            if (from <= 0 && to >= 0 && from != to) interval.up = corner;
            if (from >= 0 && to <= 0 && from != to) interval.down = corner;
            if (from == to) interval = {corner, corner};
        } else if (here * sides.of[next] < 0) {
            if (here < 0) {
                interval.up = {own.corners[i], own.corners[next], plane};
            } else {
                interval.down = {own.corners[next], own.corners[i], plane};
            }
        }
    }
    return interval;
}

/// Which of two ends comes first along the line of two planes, in the direction of the product of
/// a's normal and b's: 1 a's, -1 b's, 0 they coincide. `sides`: of a's corners from b's
/// plane.
int TriangleArrangement::order(const Triangle& a, const Sides& sides, const End& on_a,
                               const Triangle& b, const End& on_b) const {
    if (on_a.to != kNone && on_b.to != kNone)
        return orient3d(points_, on_a.from, on_a.to, on_b.from, on_b.to);
    if (on_a.to != kNone) return orientation(a, on_a.from, on_a.to, on_b.from);
    if (on_b.to != kNone) return orientation(b, on_b.from, on_b.to, on_a.from);
    std::size_t off = 0;
    while (sides.of[off] == 0)
        ++off;
    return -sides.of[off] * orientation(a, a.corners[off], on_a.from, on_b.from);
}

std::optional<TriangleArrangement::Intersection> TriangleArrangement::intersection(
    std::int32_t one, std::int32_t other) const {
    const Triangle &a = triangles_[index(one)], &b = triangles_[index(other)];
    if (a.facing == 0 || b.facing == 0) return std::nullopt;
    const auto shared = std::count_if(a.corners.begin(), a.corners.end(), [&b](SpacePointId p) {
        return std::find(b.corners.begin(), b.corners.end(), p) != b.corners.end();
    });
    std::array<Sides, 2> sides;
    for (std::size_t which = 0; which < 2; ++which) {
        sides[which] = which == 0 ? sides_of(a, b) : sides_of(b, a);
        const auto [low, high] = std::minmax(sides[which].above, sides[which].below);
        if (high == 3 || (shared == 1 && high == 2 && low == 0)) return std::nullopt;
        if (which == 0 && high == 0) {
            if (shared == 2 && are_folded_apart(a, b)) return std::nullopt;
            return Intersection{one, other, true, {}};
        }
        if (shared >= 2) return std::nullopt;  // an edge is all that they have in common
    }
    const Interval of_a = interval_of(a, sides[0], other), of_b = interval_of(b, sides[1], one);
    // along the product of both normals a is passed from `up` to `down`, and b from `down` to `up`
    const auto order_of = [&](const End& on_a, const End& on_b) {
        return order(a, sides[0], on_a, b, on_b);
    };
    if (order_of(of_a.down, of_b.down) > 0 || order_of(of_a.up, of_b.up) < 0) return std::nullopt;
    const int first = order_of(of_a.up, of_b.down), last = order_of(of_a.down, of_b.up);
    // of two that coincide a corner, which has a number
    const bool from_b = first > 0 || (first == 0 && of_a.up.to != kNone);
    const bool to_b = last < 0 || (last == 0 && of_a.down.to != kNone);
    return Intersection{
        one, other, false, {from_b ? of_b.down : of_a.up, to_b ? of_b.up : of_a.down}};
}

void TriangleArrangement::insert(const Intersection& intersection) {
    if (intersection.in_one_plane) {
        clip_edges(intersection.one, intersection.other);
        clip_edges(intersection.other, intersection.one);
        in_one_plane_.push_back({intersection.one, intersection.other});
        return;
    }
    std::array<SpacePointId, 2> ends;
    for (std::size_t i = 0; i < 2; ++i) {
        const End& end = intersection.ends[i];
        const auto& plane = triangles_[index(end.plane)].corners;
        ends[i] = end.to == kNone
                      ? end.from
                      : points_.intersection(end.from, end.to, plane[0], plane[1], plane[2]);
    }
    add_segment(intersection.one, intersection.other, ends[0], ends[1]);
}

/// Where the edges of one triangle run over another in its plane.
void TriangleArrangement::clip_edges(std::int32_t edges_of, std::int32_t into) {
    const auto corners = triangles_[index(edges_of)].corners;
    for (std::size_t i = 0; i < 3; ++i)
        clip_segment(corners[i], corners[(i + 1) % 3], edges_of, into);
}

/// Where a interval of one triangle runs over another in its plane.
void TriangleArrangement::clip_segment(SpacePointId p, SpacePointId q, std::int32_t of,
                                       std::int32_t into) {
    const Triangle& t = triangles_[index(into)];
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

/// Where two triangles lie in one plane, what meets one of them there divides the other as well,
/// whether or not the two were asked for.
void TriangleArrangement::exchange_segments() {
    struct Found {
        Segment segment;
        std::int32_t of, into;
    };
    std::vector<Found> found;
    for (const auto& [one, other] : in_one_plane_) {
        for (const auto& [of, into] : {std::pair(one, other), std::pair(other, one)}) {
            for (const Segment& s : triangles_[index(of)].segments) {
                if (s.other != into) found.push_back({s, of, into});
            }
        }
    }
    for (const auto& [segment, of, into] : found)
        clip_segment(segment.ends[0], segment.ends[1], of, into);
}

/// Finds the nodes of one triangle on lines in it.
class TriangleArrangement::NodesOnLines {
public:
    NodesOnLines(const TriangleArrangement& arrangement, const Triangle& t)
        : arrangement_(arrangement),
          points_(arrangement.points_),
          t_(t),
          axis_((t.axis + 1) % 3),
          in_order_(t.points) {
        std::sort(in_order_.begin(), in_order_.end(), [this](SpacePointId p, SpacePointId q) {
            return std::pair(coordinate(p), p) < std::pair(coordinate(q), q);
        });
    }

    /// The nodes between two others, in order from the first to the second.
    std::vector<SpacePointId> operator()(SpacePointId a, SpacePointId b) const {
        std::vector<SpacePointId> found;
        for (const SpacePointId p : t_.corners) {
            if (is_between(p, a, b)) found.push_back(p);
        }
        const auto [low, high] = std::minmax({coordinate(a), coordinate(b)});
        auto next =
            std::lower_bound(in_order_.begin(), in_order_.end(), low,
                             [this](SpacePointId p, double x) { return coordinate(p) < x; });
        for (; next != in_order_.end() && coordinate(*next) <= high; ++next) {
            if (is_between(*next, a, b) &&
                std::find(found.begin(), found.end(), *next) == found.end())
                found.push_back(*next);
        }
        const int direction = compare(points_, a, b);
        std::sort(found.begin(), found.end(), [this, direction](SpacePointId p, SpacePointId q) {
            return compare(points_, p, q) * direction > 0;
        });
        return found;
    }

private:
    double coordinate(SpacePointId p) const { return points_.rounded(p)[axis_]; }
    /// In the view in which the triangle has an area, nothing in its plane falls together.
    bool is_between(SpacePointId p, SpacePointId a, SpacePointId b) const {
        if (p == a || p == b) return false;
        const Position &r = points_.rounded(p), &s = points_.rounded(a), &e = points_.rounded(b);
        for (std::size_t k = 0; k < 3; ++k) {
            if (r[k] < std::min(s[k], e[k]) || r[k] > std::max(s[k], e[k])) return false;
        }
        if (!points_.was_constructed_on(p, a, b) && arrangement_.orientation(t_, a, b, p) != 0)
            return false;
        return compare(points_, a, p) * compare(points_, p, b) > 0;
    }

    const TriangleArrangement& arrangement_;
    const exact::SpacePoints& points_;
    const Triangle& t_;
    std::size_t axis_;
    std::vector<SpacePointId> in_order_;  ///< the triangle's points in the order of one coordinate
};

/// Puts the points and segments of all triangles in order, each once.
void TriangleArrangement::sort_all(int threads, const Progress* progress) {
    each_triangle(threads, progress, [this](std::size_t i) {
        const auto order = [](auto& of) {
            std::sort(of.begin(), of.end());
            of.erase(std::unique(of.begin(), of.end()), of.end());
        };
        order(triangles_[i].points);
        order(triangles_[i].segments);
    });
}

/// Pairs of segments of one triangle that cross each other.
std::vector<TriangleArrangement::SegmentPair> TriangleArrangement::crossing_segments(
    const Triangle& t) const {
    std::vector<SegmentPair> found;
    if (t.facing == 0) return found;
    struct Boxed {
        const Segment* segment;
        Box box;
    };
    std::vector<Boxed> boxed;
    for (const Segment& s : t.segments) {
        Boxed& own = boxed.emplace_back(Boxed{&s, {}});
        for (const SpacePointId end : s.ends)
            own.box.include(points_.rounded(end));
    }
    const std::size_t axis = (t.axis + 1) % 3;
    std::sort(boxed.begin(), boxed.end(), [&](const Boxed& s, const Boxed& r) {
        const double x = s.box.low[axis], y = r.box.low[axis];
        return x != y ? x < y : *s.segment < *r.segment;
    });
    for (std::size_t i = 0; i < boxed.size(); ++i) {
        const auto [a, b] = boxed[i].segment->ends;
        for (std::size_t j = i + 1; j < boxed.size(); ++j) {
            if (boxed[j].box.low[axis] > boxed[i].box.high[axis]) break;
            const auto [c, d] = boxed[j].segment->ends;
            if (a == c || a == d || b == c || b == d) continue;
            if (!boxed[i].box.meets(boxed[j].box)) continue;
            if (orientation(t, a, b, c) * orientation(t, a, b, d) >= 0) continue;
            if (orientation(t, c, d, a) * orientation(t, c, d, b) >= 0) continue;
            found.push_back({a, b, c, d});
        }
    }
    return found;
}

/// Notes where segments of one triangle cross each other: only where the triangles of a group do
/// cross.
void TriangleArrangement::intersect_segments(int threads, const Progress* progress) {
    std::vector<std::vector<SegmentPair>> found(triangles_.size());
    each_triangle(threads, progress,
                  [&](std::size_t i) { found[i] = crossing_segments(triangles_[i]); });
    for (std::size_t i = 0; i < found.size(); ++i) {
        for (const auto& [a, b, c, d] : found[i])
            triangles_[i].points.push_back(points_.intersection(triangles_[i].axis, a, b, c, d));
    }
}

/// The points on the edges and segments of a triangle, for the others that share these.
void TriangleArrangement::messages_of(std::int32_t triangle, std::vector<Message>& messages) const {
    const Triangle& t = triangles_[index(triangle)];
    // of a triangle without area one corner may lie on the edge between the others
    if (t.points.empty() && t.facing != 0) return;
    const NodesOnLines nodes_on(*this, t);
    const auto send = [&](std::int32_t to, SpacePointId p) {
        const Triangle& other = triangles_[index(to)];
        if (to == triangle ||
            std::find(other.corners.begin(), other.corners.end(), p) != other.corners.end() ||
            std::binary_search(other.points.begin(), other.points.end(), p))
            return;
        messages.push_back({to, p});
    };
    for (const Segment& s : t.segments) {
        for (const SpacePointId p : nodes_on(s.ends[0], s.ends[1]))
            send(s.other, p);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const SpacePointId a = t.corners[i], b = t.corners[(i + 1) % 3];
        const auto on = nodes_on(a, b);
        if (on.empty()) continue;
        const auto edge = unordered(a, b);
        for (auto other = std::lower_bound(of_edge_.begin(), of_edge_.end(), std::pair(edge, 0));
             other != of_edge_.end() && other->first == edge; ++other) {
            for (const SpacePointId p : on)
                send(other->second, p);
        }
    }
}

/// Sends the points on edges and segments to the other triangles that share these, until all of
/// them know them.
void TriangleArrangement::exchange_points(int threads, const Progress* progress) {
    std::vector<std::int32_t> changed(triangles_.size());
    std::iota(changed.begin(), changed.end(), 0);
    while (!changed.empty()) {
        std::vector<std::vector<Message>> messages((changed.size() + kChunk - 1) / kChunk);
        parallel_ranges(changed.size(), kChunk, threads, progress,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i)
                                messages_of(changed[i], messages[begin / kChunk]);
                        });
        changed.clear();
        for (const auto& chunk : messages) {
            for (const Message& message : chunk) {
                auto& points = triangles_[index(message.to)].points;
                const auto at = std::lower_bound(points.begin(), points.end(), message.point);
                if (at != points.end() && *at == message.point) continue;
                points.insert(at, message.point);
                changed.push_back(message.to);
            }
        }
        std::sort(changed.begin(), changed.end());
        changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    }
}

void TriangleArrangement::find_regions(std::int32_t triangle, std::vector<Region>& regions) const {
    const Triangle& t = triangles_[index(triangle)];
    if (t.points.empty() && t.segments.empty()) {
        regions.push_back({triangle, {{t.corners[0], t.corners[1], t.corners[2]}}});
        return;
    }
    const NodesOnLines nodes_on(*this, t);
    std::vector<std::array<SpacePointId, 2>> edges;
    const auto add_edges = [&](SpacePointId a, SpacePointId b) {
        SpacePointId last = a;
        for (const SpacePointId p : nodes_on(a, b)) {
            edges.push_back(unordered(last, p));
            last = p;
        }
        edges.push_back(unordered(last, b));
    };
    for (std::size_t i = 0; i < 3; ++i)
        add_edges(t.corners[i], t.corners[(i + 1) % 3]);
    for (const Segment& s : t.segments)
        add_edges(s.ends[0], s.ends[1]);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (RegionLoops& loops : regions_of_graph(points_, {t.axis, t.facing}, edges))
        regions.push_back({triangle, std::move(loops)});
}

void TriangleArrangement::divide(int threads, const Progress* progress) {
    parallel_sort(of_edge_, std::less<>(), threads, progress);
    sort_all(threads, progress);
    exchange_segments();
    sort_all(threads, progress);
    intersect_segments(threads, progress);
    sort_all(threads, progress);
    exchange_points(threads, progress);
    std::vector<std::vector<Region>> found((triangles_.size() + kChunk - 1) / kChunk);
    each_triangle(threads, progress, [&](std::size_t i) {
        if (triangles_[i].facing != 0)
            find_regions(static_cast<std::int32_t>(i), found[i / kChunk]);
    });
    std::size_t count = 0;
    for (const auto& regions : found)
        count += regions.size();
    checked_number(count, "regions of triangles");
    regions_.reserve(count);
    for (auto& regions : found)
        std::move(regions.begin(), regions.end(), std::back_inserter(regions_));
}

}  // namespace realmodel::arrangement
