// SPDX-License-Identifier: GPL-3.0-or-later
// Where triangles meet, and how the points that come of it reach all that share them.
#include "cutting/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/parallel_counts.hpp"
#include "base/parallel_sort.hpp"

namespace realmodel::cutting {

namespace {

/// So many triangles are one piece of work.
constexpr std::size_t kChunk = 1 << 8;

std::array<NodeId, 2> unordered(NodeId a, NodeId b) {
    return {std::min(a, b), std::max(a, b)};
}

}  // namespace

std::int32_t Overlay::add(const std::array<NodeId, 3>& corners) {
    const auto number = static_cast<std::int32_t>(triangles_.size());
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
        t.turned = points_.turn(axis, corners[0], corners[1], corners[2]);
        if (t.turned != 0) break;
    }
    for (std::size_t i = 0; i < 3; ++i)
        of_edge_.push_back({unordered(corners[i], corners[(i + 1) % 3]), number});
    triangles_.push_back(std::move(t));
    return number;
}

NodeId Overlay::left_corner(std::int32_t triangle, NodeId from, NodeId to) const {
    const Triangle& t = triangles_[index(triangle)];
    for (const NodeId corner : t.corners) {
        if (turn(t, from, to, corner) > 0) return corner;
    }
    return t.corners[0];
}

void Overlay::share(std::int32_t one, std::int32_t other, NodeId p, NodeId q) {
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
void Overlay::each_triangle(int threads, const Progress* progress, const Visit& visit) const {
    parallel_ranges(triangles_.size(), kChunk, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i)
                            visit(i);
                    });
}

Overlay::Sides Overlay::sides_of(const Triangle& own, const Triangle& plane) const {
    Sides sides;
    for (std::size_t i = 0; i < 3; ++i) {
        sides.of[i] = points_.orientation(plane.corners[0], plane.corners[1], plane.corners[2],
                                          own.corners[i]);
        sides.above += sides.of[i] > 0;
        sides.below += sides.of[i] < 0;
    }
    return sides;
}

/// Of two triangles in one plane with two corners in common: whether neither covers a part of the
/// other.
bool Overlay::are_folded_apart(const Triangle& a, const Triangle& b) const {
    std::array<NodeId, 2> edge{}, tip{};
    std::size_t found = 0;
    for (const NodeId p : a.corners) {
        const bool both = std::find(b.corners.begin(), b.corners.end(), p) != b.corners.end();
        if (both) {
            edge[found++] = p;
        } else {
            tip[0] = p;
        }
    }
    for (const NodeId p : b.corners) {
        if (p != edge[0] && p != edge[1]) tip[1] = p;
    }
    return turn(a, edge[0], edge[1], tip[0]) != turn(a, edge[0], edge[1], tip[1]);
}

Overlay::Stretch Overlay::stretch_of(const Triangle& own, const Sides& sides, std::int32_t plane) {
    Stretch stretch{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3, before = (i + 2) % 3;
        const int here = sides.of[i];
        if (here == 0) {
            const int from = sides.of[before], to = sides.of[next];
            const End corner{own.corners[i]};
            if (from <= 0 && to >= 0 && from != to) stretch.up = corner;
            if (from >= 0 && to <= 0 && from != to) stretch.down = corner;
            if (from == to) stretch = {corner, corner};
        } else if (here * sides.of[next] < 0) {
            if (here < 0) {
                stretch.up = {own.corners[i], own.corners[next], plane};
            } else {
                stretch.down = {own.corners[next], own.corners[i], plane};
            }
        }
    }
    return stretch;
}

/// Which of two ends comes first along the line of two planes, in the direction of the product of
/// a's normal and b's: 1 a's, -1 b's, 0 they are in one place. `sides`: of a's corners from b's
/// plane.
int Overlay::order(const Triangle& a, const Sides& sides, const End& on_a, const Triangle& b,
                   const End& on_b) const {
    if (on_a.to >= 0 && on_b.to >= 0)
        return points_.orientation(on_a.from, on_a.to, on_b.from, on_b.to);
    if (on_a.to >= 0) return turn(a, on_a.from, on_a.to, on_b.from);
    if (on_b.to >= 0) return turn(b, on_b.from, on_b.to, on_a.from);
    std::size_t off = 0;
    while (sides.of[off] == 0)
        ++off;
    return -sides.of[off] * turn(a, a.corners[off], on_a.from, on_b.from);
}

std::optional<Overlay::Meeting> Overlay::meeting(std::int32_t one, std::int32_t other) const {
    const Triangle &a = triangles_[index(one)], &b = triangles_[index(other)];
    if (a.turned == 0 || b.turned == 0) return std::nullopt;
    const auto shared = std::count_if(a.corners.begin(), a.corners.end(), [&b](NodeId p) {
        return std::find(b.corners.begin(), b.corners.end(), p) != b.corners.end();
    });
    std::array<Sides, 2> sides;
    for (std::size_t which = 0; which < 2; ++which) {
        sides[which] = which == 0 ? sides_of(a, b) : sides_of(b, a);
        const auto [low, high] = std::minmax(sides[which].above, sides[which].below);
        if (high == 3 || (shared == 1 && high == 2 && low == 0)) return std::nullopt;
        if (which == 0 && high == 0) {
            if (shared == 2 && are_folded_apart(a, b)) return std::nullopt;
            return Meeting{one, other, true, {}};
        }
        if (shared >= 2) return std::nullopt;  // an edge is all that they have in common
    }
    const Stretch of_a = stretch_of(a, sides[0], other), of_b = stretch_of(b, sides[1], one);
    // along the product of both normals a is passed from `up` to `down`, and b from `down` to `up`
    const auto order_of = [&](const End& on_a, const End& on_b) {
        return order(a, sides[0], on_a, b, on_b);
    };
    if (order_of(of_a.down, of_b.down) > 0 || order_of(of_a.up, of_b.up) < 0) return std::nullopt;
    const int first = order_of(of_a.up, of_b.down), last = order_of(of_a.down, of_b.up);
    // of two in one place a corner, which has a number
    const bool from_b = first > 0 || (first == 0 && of_a.up.to >= 0);
    const bool to_b = last < 0 || (last == 0 && of_a.down.to >= 0);
    return Meeting{one, other, false, {from_b ? of_b.down : of_a.up, to_b ? of_b.up : of_a.down}};
}

void Overlay::take(const Meeting& meeting) {
    if (meeting.in_one_plane) {
        meet_in_plane(meeting.one, meeting.other);
        return;
    }
    std::array<NodeId, 2> ends;
    for (std::size_t i = 0; i < 2; ++i) {
        const End& end = meeting.ends[i];
        const auto& plane = triangles_[index(end.plane)].corners;
        ends[i] = end.to < 0 ? end.from
                             : points_.crossing(end.from, end.to, plane[0], plane[1], plane[2]);
    }
    share(meeting.one, meeting.other, ends[0], ends[1]);
}

void Overlay::meet_in_plane(std::int32_t one, std::int32_t other) {
    clip_edges(one, other);
    clip_edges(other, one);
    in_one_plane_.push_back({one, other});
}

/// Where the edges of one triangle run over another in its plane.
void Overlay::clip_edges(std::int32_t edges_of, std::int32_t into) {
    const auto corners = triangles_[index(edges_of)].corners;
    for (std::size_t i = 0; i < 3; ++i)
        clip_segment(corners[i], corners[(i + 1) % 3], edges_of, into);
}

/// Where a stretch of one triangle runs over another in its plane.
void Overlay::clip_segment(NodeId p, NodeId q, std::int32_t of, std::int32_t into) {
    const Triangle& t = triangles_[index(into)];
    for (std::size_t k = 0; k < 3; ++k) {
        const NodeId a = t.corners[k], b = t.corners[(k + 1) % 3];
        const int first = turn(t, a, b, p), second = turn(t, a, b, q);
        if (first < 0 && second < 0) return;
        if (first < 0 && second == 0) p = q;
        if (first == 0 && second < 0) q = p;
        if (first * second >= 0) continue;
        const NodeId c = points_.crossing(t.axis, p, q, a, b);
        (first < 0 ? p : q) = c;
    }
    share(of, into, p, q);
}

/// Where two triangles lie in one plane, what meets one of them there divides the other as well,
/// whether or not the two were asked for.
void Overlay::exchange_segments() {
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

/// Whether a point lies between two others, both of them counted out, all of them on a triangle: in
/// the view in which that has an area, nothing in its plane falls together.
bool Overlay::on_segment(const Triangle& t, NodeId p, NodeId a, NodeId b) const {
    if (p == a || p == b) return false;
    const Position &r = points_.rounded(p), &s = points_.rounded(a), &e = points_.rounded(b);
    for (std::size_t k = 0; k < 3; ++k) {
        if (r[k] < std::min(s[k], e[k]) || r[k] > std::max(s[k], e[k])) return false;
    }
    if (!points_.was_made_on(p, a, b) && turn(t, a, b, p) != 0) return false;
    return points_.compare(a, p) * points_.compare(p, b) > 0;
}

/// The points of a triangle that may lie between two of them.
std::span<const NodeId> Overlay::points_between(const Triangle& t, NodeId a, NodeId b) const {
    const std::size_t axis = (t.axis + 1) % 3;
    const auto before = [&](NodeId p, double x) { return points_.rounded(p)[axis] < x; };
    const auto after = [&](double x, NodeId p) { return x < points_.rounded(p)[axis]; };
    if (t.in_order.size() != t.points.size()) {
        t.in_order = t.points;
        std::sort(t.in_order.begin(), t.in_order.end(), [&](NodeId p, NodeId q) {
            return std::pair(points_.rounded(p)[axis], p) < std::pair(points_.rounded(q)[axis], q);
        });
    }
    const double x = points_.rounded(a)[axis], y = points_.rounded(b)[axis];
    const auto first =
        std::lower_bound(t.in_order.begin(), t.in_order.end(), std::min(x, y), before);
    const auto last = std::upper_bound(first, t.in_order.end(), std::max(x, y), after);
    return {first, last};
}

/// The nodes of a triangle between two of them, in order from the first to the second.
std::vector<NodeId> Overlay::nodes_on(const Triangle& t, NodeId a, NodeId b) const {
    std::vector<NodeId> found;
    for (const NodeId p : t.corners) {
        if (on_segment(t, p, a, b)) found.push_back(p);
    }
    for (const NodeId p : points_between(t, a, b)) {
        if (on_segment(t, p, a, b) && std::find(found.begin(), found.end(), p) == found.end())
            found.push_back(p);
    }
    const int way = points_.compare(a, b);
    std::sort(found.begin(), found.end(),
              [this, way](NodeId p, NodeId q) { return points_.compare(p, q) * way > 0; });
    return found;
}

/// Puts the points and segments of all triangles in order, each once.
void Overlay::settle(int threads, const Progress* progress) {
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
std::vector<Overlay::Cross> Overlay::crossing_segments(const Triangle& t) const {
    std::vector<Cross> found;
    if (t.turned == 0) return found;
    struct Boxed {
        const Segment* segment;
        Box box;
    };
    std::vector<Boxed> boxed;
    for (const Segment& s : t.segments) {
        Boxed& own = boxed.emplace_back(Boxed{&s, {}});
        for (const NodeId end : s.ends)
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
            if (turn(t, a, b, c) * turn(t, a, b, d) >= 0) continue;
            if (turn(t, c, d, a) * turn(t, c, d, b) >= 0) continue;
            found.push_back({a, b, c, d});
        }
    }
    return found;
}

/// Notes where segments of one triangle cross each other: only where the triangles of a group do
/// cross.
void Overlay::cross_segments(int threads, const Progress* progress) {
    std::vector<std::vector<Cross>> found(triangles_.size());
    each_triangle(threads, progress,
                  [&](std::size_t i) { found[i] = crossing_segments(triangles_[i]); });
    for (std::size_t i = 0; i < found.size(); ++i) {
        for (const auto& [a, b, c, d] : found[i])
            triangles_[i].points.push_back(points_.crossing(triangles_[i].axis, a, b, c, d));
    }
}

/// What the points on the edges and segments of a triangle are to the others that share these.
void Overlay::hand_on(std::int32_t triangle, std::vector<Hand>& hands) const {
    const Triangle& t = triangles_[index(triangle)];
    // of a triangle without area one corner may lie on the edge between the others
    if (t.points.empty() && t.turned != 0) return;
    const auto hand = [&](std::int32_t to, NodeId p) {
        const Triangle& other = triangles_[index(to)];
        if (to == triangle ||
            std::find(other.corners.begin(), other.corners.end(), p) != other.corners.end() ||
            std::binary_search(other.points.begin(), other.points.end(), p))
            return;
        hands.push_back({to, p});
    };
    for (const Segment& s : t.segments) {
        for (const NodeId p : nodes_on(t, s.ends[0], s.ends[1]))
            hand(s.other, p);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const NodeId a = t.corners[i], b = t.corners[(i + 1) % 3];
        const auto on = nodes_on(t, a, b);
        if (on.empty()) continue;
        const auto edge = unordered(a, b);
        for (auto other = std::lower_bound(of_edge_.begin(), of_edge_.end(), std::pair(edge, 0));
             other != of_edge_.end() && other->first == edge; ++other) {
            for (const NodeId p : on)
                hand(other->second, p);
        }
    }
}

/// Hands the points on edges and segments to the other triangles that share these, until all of
/// them know them.
void Overlay::spread_points(int threads, const Progress* progress) {
    std::vector<std::int32_t> changed(triangles_.size());
    std::iota(changed.begin(), changed.end(), 0);
    while (!changed.empty()) {
        std::vector<std::vector<Hand>> hands((changed.size() + kChunk - 1) / kChunk);
        parallel_ranges(changed.size(), kChunk, threads, progress,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i)
                                hand_on(changed[i], hands[begin / kChunk]);
                        });
        changed.clear();
        for (const auto& chunk : hands) {
            for (const Hand& hand : chunk) {
                auto& points = triangles_[index(hand.to)].points;
                const auto at = std::lower_bound(points.begin(), points.end(), hand.point);
                if (at != points.end() && *at == hand.point) continue;
                points.insert(at, hand.point);
                changed.push_back(hand.to);
            }
        }
        std::sort(changed.begin(), changed.end());
        changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    }
}

void Overlay::divide(int threads, const Progress* progress) {
    parallel_sort(of_edge_, std::less<>(), threads, progress);
    settle(threads, progress);
    exchange_segments();
    settle(threads, progress);
    cross_segments(threads, progress);
    settle(threads, progress);
    spread_points(threads, progress);
    std::vector<std::vector<Region>> found((triangles_.size() + kChunk - 1) / kChunk);
    each_triangle(threads, progress, [&](std::size_t i) {
        if (triangles_[i].turned != 0)
            find_regions(static_cast<std::int32_t>(i), found[i / kChunk]);
    });
    for (auto& regions : found)
        std::move(regions.begin(), regions.end(), std::back_inserter(regions_));
}

}  // namespace realmodel::cutting
