// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangle_arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "arrangement/triangle_regions.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "base/parallel_sort.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::arrangement {

using exact::compare;
using exact::orient3d;
using spatial::Box;

namespace {

/// So many triangles, or lines of a large one, are one piece of work.
constexpr std::size_t kChunk = 1 << 8;
/// So many points or segments make a triangle a large one: its lines are shared among threads, and
/// found by a tree.
constexpr std::size_t kLarge = 1 << 9;

Box box_of(const exact::SpacePoints& points, const std::array<SpacePointId, 2>& line) {
    Box box;
    for (const SpacePointId end : line)
        box.include(points.rounded(end));
    return box;
}

/// The results of all ranges, one after another.
template <class Item>
std::vector<Item> joined(std::vector<std::vector<Item>>& ranges) {
    std::vector<Item> all;
    for (auto& range : ranges)
        all.insert(all.end(), std::make_move_iterator(range.begin()),
                   std::make_move_iterator(range.end()));
    return all;
}

}  // namespace

TriangleArrangement::Triangle TriangleArrangement::triangle_of(
    const std::array<SpacePointId, 3>& corners) const {
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
    return t;
}

std::int32_t TriangleArrangement::add(const std::array<SpacePointId, 3>& corners) {
    const std::int32_t number = checked_number(triangles_.size(), "triangles");
    add_all({&corners, 1}, 1, nullptr);
    return number;
}

void TriangleArrangement::add_all(std::span<const std::array<SpacePointId, 3>> corners, int threads,
                                  const Progress* progress) {
    const std::size_t before = triangles_.size();
    checked_number(before + corners.size(), "triangles");
    triangles_.resize(before + corners.size());
    of_edge_.resize(3 * triangles_.size());
    parallel_ranges(
        corners.size(), kChunk, threads, progress,
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

void TriangleArrangement::set_outline(std::int32_t triangle,
                                      std::span<const SpacePointId> outline) {
    Triangle& t = triangles_[index(triangle)];
    t.outline.assign(outline.begin(), outline.end());
    std::ranges::copy_if(outline, std::back_inserter(t.points), [&t](SpacePointId p) {
        return std::ranges::find(t.corners, p) == t.corners.end();
    });
    for (std::size_t i = 0; i < t.edge_count(); ++i) {
        const auto [a, b] = t.edge(i);
        of_edge_.push_back({unordered(a, b), triangle});
    }
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
        const End& whole = intersection.ends[i];
        const bool of_one = whole.plane == intersection.other;
        const End end =
            whole.to == kNone
                ? whole
                : on_sub_edge(triangles_[index(of_one ? intersection.one : intersection.other)],
                              whole);
        const auto& plane = triangles_[index(end.plane)].corners;
        ends[i] = end.to == kNone
                      ? end.from
                      : points_.intersection(end.from, end.to, plane[0], plane[1], plane[2]);
    }
    add_segment(intersection.one, intersection.other, ends[0], ends[1]);
}

/// Of an end between two corners: between which nodes of that edge it is, or the node that it is.
TriangleArrangement::End TriangleArrangement::on_sub_edge(const Triangle& own,
                                                          const End& end) const {
    const auto& nodes = own.outline;
    if (nodes.empty()) return end;
    const auto& plane = triangles_[index(end.plane)].corners;
    const auto start = static_cast<std::size_t>(std::ranges::find(nodes, end.from) - nodes.begin());
    const std::size_t n = nodes.size();
    // towards the other corner: of the two ways around that which comes to it first
    const auto is_forward = [&] {
        for (std::size_t i = 1;; ++i) {
            const SpacePointId p = nodes[(start + i) % n];
            if (std::ranges::find(own.corners, p) != own.corners.end()) return p == end.to;
        }
    };
    const std::size_t step = is_forward() ? 1 : n - 1;
    SpacePointId below = end.from;
    for (std::size_t i = (start + step) % n; nodes[i] != end.to; i = (i + step) % n) {
        const int side = orient3d(points_, plane[0], plane[1], plane[2], nodes[i]);
        if (side == 0) return {nodes[i]};
        if (side > 0) return {below, nodes[i], end.plane};
        below = nodes[i];
    }
    return {below, end.to, end.plane};
}

/// Where the edges of one triangle run over another in its plane.
void TriangleArrangement::clip_edges(std::int32_t edges_of, std::int32_t into) {
    for (std::size_t i = 0; i < triangles_[index(edges_of)].edge_count(); ++i) {
        const auto [a, b] = triangles_[index(edges_of)].edge(i);
        clip_segment(a, b, edges_of, into);
    }
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
    explicit NodesOnLines(const TriangleArrangement& arrangement)
        : arrangement_(arrangement), points_(arrangement.points_) {}
    NodesOnLines(const TriangleArrangement& arrangement, const Triangle& t)
        : NodesOnLines(arrangement) {
        take(t);
    }

    /// Goes on to another triangle.
    void take(const Triangle& t) {
        t_ = &t;
        axis_ = (t.axis + 1) % 3;
        tree_.reset();
        in_order_.assign(t.points.begin(), t.points.end());
        if (in_order_.size() > kLarge) {
            std::vector<Box> boxes(in_order_.size());
            for (std::size_t i = 0; i < boxes.size(); ++i)
                boxes[i].include(points_.rounded(in_order_[i]));
            tree_.emplace(std::move(boxes));
            return;
        }
        std::sort(in_order_.begin(), in_order_.end(), [this](SpacePointId p, SpacePointId q) {
            return std::pair(coordinate(p), p) < std::pair(coordinate(q), q);
        });
    }

    /// The nodes between two others, in order from the first to the second.
    void find(const std::array<SpacePointId, 2>& line, std::vector<SpacePointId>& found) const {
        const SpacePointId a = line[0], b = line[1];
        found.clear();
        const auto visit = [&](SpacePointId p) {
            if (is_between(p, a, b)) found.push_back(p);
        };
        std::ranges::for_each(t_->corners, visit);
        const auto visit_point = [&](SpacePointId p) {
            if (std::ranges::find(t_->corners, p) == t_->corners.end()) visit(p);
        };
        if (tree_) {
            tree_->find(box_of(points_, line),
                        [&](std::int32_t i) { visit_point(in_order_[index(i)]); });
        } else {
            const auto [low, high] = std::minmax({coordinate(a), coordinate(b)});
            auto next =
                std::lower_bound(in_order_.begin(), in_order_.end(), low,
                                 [this](SpacePointId p, double x) { return coordinate(p) < x; });
            for (; next != in_order_.end() && coordinate(*next) <= high; ++next)
                visit_point(*next);
        }
        if (found.size() < 2) return;
        const int direction = compare(points_, a, b);
        std::sort(found.begin(), found.end(), [this, direction](SpacePointId p, SpacePointId q) {
            return compare(points_, p, q) * direction > 0;
        });
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
        if (!points_.was_constructed_on(p, a, b) && arrangement_.orientation(*t_, a, b, p) != 0)
            return false;
        return compare(points_, a, p) * compare(points_, p, b) > 0;
    }

    const TriangleArrangement& arrangement_;
    const exact::SpacePoints& points_;
    const Triangle* t_ = nullptr;
    std::size_t axis_ = 0;
    /// The triangle's points: in the order of one coordinate, unless there is a tree of them.
    std::vector<SpacePointId> in_order_;
    std::optional<spatial::BoxTree> tree_;
};

/// Those of some triangles that have many points or segments.
std::vector<std::int32_t> TriangleArrangement::large_triangles(
    std::span<const std::int32_t> among) const {
    std::vector<std::int32_t> found;
    for (const std::int32_t triangle : among) {
        const Triangle& t = triangles_[index(triangle)];
        if (t.facing != 0 && std::max(t.points.size(), t.segments.size()) > kLarge)
            found.push_back(triangle);
    }
    return found;
}

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

/// Whether segments of a triangle whose boxes meet cross each other.
bool TriangleArrangement::do_cross(const Triangle& t, const SegmentPair& pair) const {
    const auto& [a, b, c, d] = pair;
    if (a == c || a == d || b == c || b == d) return false;
    return orientation(t, a, b, c) * orientation(t, a, b, d) < 0 &&
           orientation(t, c, d, a) * orientation(t, c, d, b) < 0;
}

namespace {

/// Segments of a triangle with the boxes around them, in the order of one coordinate of these.
template <class Segment>
struct BoxedSegment {
    const Segment* segment;
    Box box;
};

template <class Segment>
std::vector<BoxedSegment<Segment>> boxed_segments(const exact::SpacePoints& points,
                                                  const std::vector<Segment>& segments,
                                                  std::size_t axis) {
    std::vector<BoxedSegment<Segment>> boxed;
    boxed.reserve(segments.size());
    for (const Segment& s : segments)
        boxed.push_back({&s, box_of(points, s.ends)});
    std::sort(boxed.begin(), boxed.end(), [axis](const auto& s, const auto& r) {
        const double x = s.box.low[axis], y = r.box.low[axis];
        return x != y ? x < y : *s.segment < *r.segment;
    });
    return boxed;
}

}  // namespace

/// Pairs of segments of one triangle that cross each other.
std::vector<TriangleArrangement::SegmentPair> TriangleArrangement::crossing_segments(
    const Triangle& t) const {
    std::vector<SegmentPair> found;
    if (t.facing == 0 || t.segments.size() < 2) return found;
    const std::size_t axis = (t.axis + 1) % 3;
    const auto boxed = boxed_segments(points_, t.segments, axis);
    for (std::size_t i = 0; i < boxed.size(); ++i) {
        const auto [a, b] = boxed[i].segment->ends;
        for (std::size_t j = i + 1; j < boxed.size(); ++j) {
            if (boxed[j].box.low[axis] > boxed[i].box.high[axis]) break;
            if (!boxed[i].box.meets(boxed[j].box)) continue;
            const auto [c, d] = boxed[j].segment->ends;
            if (do_cross(t, {a, b, c, d})) found.push_back({a, b, c, d});
        }
    }
    return found;
}

/// The same, in the same order, of a large triangle.
std::vector<TriangleArrangement::SegmentPair> TriangleArrangement::crossing_segments(
    const Triangle& t, int threads, const Progress* progress) const {
    const auto boxed = boxed_segments(points_, t.segments, (t.axis + 1) % 3);
    std::vector<Box> boxes;
    boxes.reserve(boxed.size());
    for (const auto& own : boxed)
        boxes.push_back(own.box);
    const spatial::BoxTree tree(std::move(boxes));
    std::vector<std::vector<SegmentPair>> found((boxed.size() + kChunk - 1) / kChunk);
    parallel_ranges(
        boxed.size(), kChunk, threads, progress,
        [&](std::size_t begin, std::size_t end) {
            std::vector<std::size_t> near;
            for (std::size_t i = begin; i < end; ++i) {
                near.clear();
                tree.find(boxed[i].box, [&](std::int32_t j) {
                    if (index(j) > i) near.push_back(index(j));
                });
                std::sort(near.begin(), near.end());
                const auto [a, b] = boxed[i].segment->ends;
                for (const std::size_t j : near) {
                    const auto [c, d] = boxed[j].segment->ends;
                    if (do_cross(t, {a, b, c, d})) found[begin / kChunk].push_back({a, b, c, d});
                }
            }
        },
        0.02);
    return joined(found);
}

/// Notes where segments of one triangle cross each other: only where the triangles of a group do
/// cross.
void TriangleArrangement::intersect_segments(int threads, const Progress* progress) {
    std::vector<std::vector<SegmentPair>> found(triangles_.size());
    each_triangle(threads, progress, [&](std::size_t i) {
        if (triangles_[i].segments.size() <= kLarge) found[i] = crossing_segments(triangles_[i]);
    });
    std::vector<std::pair<std::size_t, SegmentPair>> pairs;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (triangles_[i].facing != 0 && triangles_[i].segments.size() > kLarge)
            found[i] = crossing_segments(triangles_[i], threads, progress);
        for (const SegmentPair& pair : found[i])
            pairs.push_back({i, pair});
        found[i] = {};
    }
    // where they do is found on all threads and numbered in order
    constexpr std::size_t kAtOnce = 1 << 14;
    std::vector<exact::SpacePoints::Reduced> at;
    for (std::size_t first = 0; first < pairs.size(); first += kAtOnce) {
        at.resize(std::min(kAtOnce, pairs.size() - first));
        parallel_ranges(
            at.size(), kChunk, threads, progress,
            [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = begin; k < end; ++k) {
                    const auto& [i, pair] = pairs[first + k];
                    const auto& [a, b, c, d] = pair;
                    at[k] = points_.crossing(triangles_[i].axis, a, b, c, d);
                }
            },
            0.02);
        for (std::size_t k = 0; k < at.size(); ++k)
            triangles_[pairs[first + k].first].points.push_back(points_.add(std::move(at[k])));
    }
}

/// The points on the edges and segments of a triangle, for the others that share these.
void TriangleArrangement::messages_of(std::int32_t triangle, NodesOnLines& nodes_on,
                                      std::vector<Message>& messages) const {
    const Triangle& t = triangles_[index(triangle)];
    // of a triangle without area one corner may lie on the edge between the others
    if (t.points.empty() && t.facing != 0) return;
    nodes_on.take(t);
    messages_of(triangle, nodes_on, 0, t.line_count(), messages);
}

/// The points on some lines of a triangle.
void TriangleArrangement::messages_of(std::int32_t triangle, const NodesOnLines& nodes_on,
                                      std::size_t begin, std::size_t end,
                                      std::vector<Message>& messages) const {
    const Triangle& t = triangles_[index(triangle)];
    const auto send = [&](std::int32_t to, SpacePointId p) {
        const Triangle& other = triangles_[index(to)];
        if (to == triangle ||
            std::find(other.corners.begin(), other.corners.end(), p) != other.corners.end() ||
            std::binary_search(other.points.begin(), other.points.end(), p))
            return;
        messages.push_back({to, p});
    };
    std::vector<SpacePointId> on;
    for (std::size_t i = begin; i < end; ++i) {
        nodes_on.find(t.line(i), on);
        if (i < t.segments.size()) {
            for (const SpacePointId p : on)
                send(t.segments[i].other, p);
            continue;
        }
        if (on.empty()) continue;
        const auto [a, b] = t.line(i);
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
        const std::vector<std::int32_t> large = large_triangles(changed);
        parallel_ranges(changed.size(), kChunk, threads, progress,
                        [&](std::size_t begin, std::size_t end) {
                            NodesOnLines nodes_on(*this);
                            for (std::size_t i = begin; i < end; ++i) {
                                if (!std::ranges::binary_search(large, changed[i]))
                                    messages_of(changed[i], nodes_on, messages[begin / kChunk]);
                            }
                        });
        for (const std::int32_t triangle : large) {
            const Triangle& t = triangles_[index(triangle)];
            const NodesOnLines nodes_on(*this, t);
            const std::size_t first = messages.size();
            messages.resize(first + (t.line_count() + kChunk - 1) / kChunk);
            parallel_ranges(
                t.line_count(), kChunk, threads, progress,
                [&](std::size_t begin, std::size_t end) {
                    messages_of(triangle, nodes_on, begin, end, messages[first + begin / kChunk]);
                },
                0.02);
        }
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

/// What some lines of a triangle are divided into.
void TriangleArrangement::find_edges(const Triangle& t, const NodesOnLines& nodes_on,
                                     std::size_t begin, std::size_t end, std::vector<Edge>& edges) {
    std::vector<SpacePointId> on;
    for (std::size_t i = begin; i < end; ++i) {
        const auto [a, b] = t.line(i);
        nodes_on.find({a, b}, on);
        SpacePointId last = a;
        for (const SpacePointId p : on) {
            edges.push_back(unordered(last, p));
            last = p;
        }
        edges.push_back(unordered(last, b));
    }
}

/// Finds the regions of one triangle after another in the same memory.
class TriangleArrangement::RegionFinder {
public:
    explicit RegionFinder(const TriangleArrangement& arrangement)
        : arrangement_(arrangement), nodes_on_(arrangement), graph_(arrangement.points_) {}

    void add_regions(std::int32_t triangle, Regions& regions) {
        const Triangle& t = arrangement_.triangles_[index(triangle)];
        if (t.facing == 0) return;
        if (t.is_whole()) {
            regions.loops.add_loop(t.nodes_around());
            regions.loops.end_region();
            regions.triangles.push_back(triangle);
            return;
        }
        edges_.clear();
        nodes_on_.take(t);
        find_edges(t, nodes_on_, 0, t.line_count(), edges_);
        add_regions(triangle, edges_, regions);
    }
    /// @param edges  all that its lines are divided into; put in order
    void add_regions(std::int32_t triangle, std::vector<Edge>& edges, Regions& regions) {
        const Triangle& t = arrangement_.triangles_[index(triangle)];
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        graph_.add_regions({t.axis, t.facing}, edges, regions.loops);
        regions.triangles.resize(regions.loops.size(), triangle);
    }

private:
    const TriangleArrangement& arrangement_;
    NodesOnLines nodes_on_;
    PlaneGraph graph_;
    std::vector<Edge> edges_;
};

/// The regions of each large triangle.
std::vector<Regions> TriangleArrangement::regions_of_large(std::span<const std::int32_t> large,
                                                           int threads,
                                                           const Progress* progress) const {
    std::vector<std::vector<Edge>> edges(large.size());
    for (std::size_t n = 0; n < large.size(); ++n) {
        const Triangle& t = triangles_[index(large[n])];
        const NodesOnLines nodes_on(*this, t);
        std::vector<std::vector<Edge>> found((t.line_count() + kChunk - 1) / kChunk);
        parallel_ranges(
            t.line_count(), kChunk, threads, progress,
            [&](std::size_t begin, std::size_t end) {
                find_edges(t, nodes_on, begin, end, found[begin / kChunk]);
            },
            0.02);
        edges[n] = joined(found);
    }
    std::vector<Regions> regions(large.size());
    parallel_chunks(
        large.size(), threads, progress,
        [&](std::size_t n) { RegionFinder(*this).add_regions(large[n], edges[n], regions[n]); },
        0.02);
    return regions;
}

namespace {

/// The regions of several ranges of triangles, one after another.
Regions joined(std::vector<Regions>& ranges, int threads, const Progress* progress) {
    std::vector<std::size_t> regions, loops, nodes;  // before each range
    for (const Regions& range : ranges) {
        regions.push_back(range.size());
        loops.push_back(range.loops.loop_begins.size() - 1);
        nodes.push_back(range.loops.nodes.size());
    }
    Regions all;
    const std::size_t count = count_before(regions);
    checked_number(count, "regions of triangles");
    all.triangles.resize(count);
    all.loops.region_begins.resize(count + 1);
    all.loops.loop_begins.resize(count_before(loops) + 1);
    all.loops.nodes.resize(count_before(nodes));
    parallel_chunks(ranges.size(), threads, progress, [&](std::size_t i) {
        const Regions range = std::move(ranges[i]);
        std::ranges::copy(range.triangles, all.triangles.begin() + regions[i]);
        std::ranges::copy(range.loops.nodes, all.loops.nodes.begin() + nodes[i]);
        const auto moved = [](const Array<std::size_t>& begins, std::size_t by, std::size_t* to) {
            for (std::size_t k = 1; k < begins.size(); ++k)
                to[k] = begins[k] + by;
        };
        moved(range.loops.region_begins, loops[i], all.loops.region_begins.data() + regions[i]);
        moved(range.loops.loop_begins, nodes[i], all.loops.loop_begins.data() + loops[i]);
    });
    return all;
}

}  // namespace

void TriangleArrangement::find_all_regions(int threads, const Progress* progress) {
    std::vector<std::int32_t> all(triangles_.size());
    std::iota(all.begin(), all.end(), 0);
    const std::vector<std::int32_t> large = large_triangles(all);
    auto of_large = regions_of_large(large, threads, progress);
    // large triangles are ranges of their own
    struct Range {
        std::size_t begin, end, large;
    };
    constexpr std::size_t kSmall = SIZE_MAX;
    std::vector<Range> ranges;
    for (std::size_t begin = 0, next = 0; begin < triangles_.size();) {
        if (next < large.size() && index(large[next]) == begin) {
            ranges.push_back({begin, begin + 1, next++});
        } else {
            const std::size_t end = next < large.size() ? index(large[next]) : triangles_.size();
            ranges.push_back({begin, std::min(end, begin + kChunk), kSmall});
        }
        begin = ranges.back().end;
    }
    std::vector<Regions> found(ranges.size());
    parallel_workers(ranges.size(), threads, progress, [&] {
        return [&, finder = RegionFinder(*this)](std::size_t r) mutable {
            if (ranges[r].large != kSmall) {
                found[r] = std::move(of_large[ranges[r].large]);
                return;
            }
            for (std::size_t i = ranges[r].begin; i < ranges[r].end; ++i)
                finder.add_regions(static_cast<std::int32_t>(i), found[r]);
        };
    });
    regions_ = joined(found, threads, progress);
}

void TriangleArrangement::divide(int threads, const Progress* progress) {
    parallel_sort(of_edge_, std::less<>(), threads, progress);
    sort_all(threads, progress);
    exchange_segments();
    sort_all(threads, progress);
    intersect_segments(threads, progress);
    sort_all(threads, progress);
    exchange_points(threads, progress);
    find_all_regions(threads, progress);
}

}  // namespace realmodel::arrangement
