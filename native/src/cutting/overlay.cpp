// SPDX-License-Identifier: GPL-3.0-or-later
// Where triangles meet, and how the points that come of it reach all that share them.
#include "overlay.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::cutting {

namespace {

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
        of_edge_[unordered(corners[i], corners[(i + 1) % 3])].push_back(number);
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
        t.points.insert(p);
        t.points.insert(q);
        if (p != q) t.segments.insert({unordered(p, q), yours});
    }
}

bool Overlay::may_meet(std::int32_t one, std::int32_t other) const {
    const Triangle &a = triangles_[index(one)], &b = triangles_[index(other)];
    if (a.turned == 0 || b.turned == 0) return false;
    std::size_t shared = 0;
    for (const NodeId p : a.corners)
        shared += static_cast<std::size_t>(std::count(b.corners.begin(), b.corners.end(), p));
    std::array<int, 2> nonzero{0, 0};
    for (std::size_t which = 0; which < 2; ++which) {
        const Triangle &own = which == 0 ? a : b, &plane = which == 0 ? b : a;
        int above = 0, below = 0;
        for (const NodeId p : own.corners) {
            const int side =
                points_.orientation(plane.corners[0], plane.corners[1], plane.corners[2], p);
            above += side > 0;
            below += side < 0;
        }
        if (above == 3 || below == 3) return false;
        if (shared == 1 && std::max(above, below) == 2 && std::min(above, below) == 0) return false;
        nonzero[which] = above + below;
    }
    if (shared < 2) return true;
    if (nonzero[0] != 0) return false;  // an edge is all that they have in common
    if (shared == 3) return true;
    // in one plane, with an edge in common: whether one is folded over the other
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
    return turn(a, edge[0], edge[1], tip[0]) == turn(a, edge[0], edge[1], tip[1]);
}

void Overlay::meet(std::int32_t one, std::int32_t other) {
    const Triangle &a = triangles_[index(one)], &b = triangles_[index(other)];
    if (a.turned == 0 || b.turned == 0) return;
    std::array<std::array<int, 3>, 2> sides;  // of the corners of each from the plane of the other
    for (std::size_t which = 0; which < 2; ++which) {
        const Triangle &own = which == 0 ? a : b, &plane = which == 0 ? b : a;
        int above = 0, below = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            sides[which][i] = points_.orientation(plane.corners[0], plane.corners[1],
                                                  plane.corners[2], own.corners[i]);
            above += sides[which][i] > 0;
            below += sides[which][i] < 0;
        }
        if (above == 3 || below == 3) return;
        if (above == 0 && below == 0) return meet_in_plane(one, other);
    }
    // the stretch that each has on the line of both planes
    std::array<std::array<NodeId, 2>, 2> stretch;
    for (std::size_t which = 0; which < 2; ++which) {
        const auto& own = (which == 0 ? a : b).corners;
        const auto& plane = (which == 0 ? b : a).corners;
        std::vector<NodeId> found;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            if (sides[which][i] == 0) found.push_back(own[i]);
            if (sides[which][i] * sides[which][j] < 0)
                found.push_back(points_.crossing(own[i], own[j], plane[0], plane[1], plane[2]));
        }
        stretch[which] = {found.front(), found.back()};
        if (points_.compare(found.front(), found.back()) > 0)
            std::swap(stretch[which][0], stretch[which][1]);
    }
    const auto later = [this](NodeId p, NodeId q) { return points_.compare(p, q) > 0 ? p : q; };
    const auto earlier = [this](NodeId p, NodeId q) { return points_.compare(p, q) > 0 ? q : p; };
    const NodeId from = later(stretch[0][0], stretch[1][0]);
    const NodeId to = earlier(stretch[0][1], stretch[1][1]);
    if (points_.compare(from, to) <= 0) share(one, other, from, to);
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
        t.in_order.assign(t.points.begin(), t.points.end());
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

/// Segments of one triangle that cross each other: only where the triangles of a group do cross.
void Overlay::cross_segments(std::int32_t triangle) {
    std::vector<Segment> segments(triangles_[index(triangle)].segments.begin(),
                                  triangles_[index(triangle)].segments.end());
    const auto box = [&](const Segment& s, std::size_t k) {
        const double p = points_.rounded(s.ends[0])[k], q = points_.rounded(s.ends[1])[k];
        return std::pair(std::min(p, q), std::max(p, q));  // minmax would refer to p and q
    };
    const std::size_t axis = (triangles_[index(triangle)].axis + 1) % 3;
    std::sort(segments.begin(), segments.end(), [&](const Segment& s, const Segment& r) {
        const double x = box(s, axis).first, y = box(r, axis).first;
        return x != y ? x < y : s < r;
    });
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const double end = box(segments[i], axis).second;
        for (std::size_t j = i + 1; j < segments.size(); ++j) {
            const auto &s = segments[i], &r = segments[j];
            if (box(r, axis).first > end) break;
            bool apart = false;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto p = box(s, k), q = box(r, k);
                apart = apart || p.second < q.first || q.second < p.first;
            }
            if (apart) continue;
            Triangle& t = triangles_[index(triangle)];
            const int a = turn(t, s.ends[0], s.ends[1], r.ends[0]);
            const int b = turn(t, s.ends[0], s.ends[1], r.ends[1]);
            if (a * b >= 0) continue;
            const int c = turn(t, r.ends[0], r.ends[1], s.ends[0]);
            const int d = turn(t, r.ends[0], r.ends[1], s.ends[1]);
            if (c * d >= 0) continue;
            t.points.insert(points_.crossing(t.axis, s.ends[0], s.ends[1], r.ends[0], r.ends[1]));
        }
    }
}

/// Hands the points on edges and segments to the other triangles that share these.
void Overlay::spread_points(const Progress* progress) {
    std::set<std::int32_t> changed;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        if (triangles_[t].turned != 0) cross_segments(static_cast<std::int32_t>(t));
        changed.insert(static_cast<std::int32_t>(t));
    }
    std::size_t round = 0;
    while (!changed.empty()) {
        if (progress != nullptr && (++round & 0xff) == 0) progress->check();
        const std::int32_t number = *changed.begin();
        changed.erase(changed.begin());
        const Triangle& t = triangles_[index(number)];
        const auto hand = [&](std::int32_t to, NodeId p) {
            Triangle& other = triangles_[index(to)];
            if (to == number ||
                std::find(other.corners.begin(), other.corners.end(), p) != other.corners.end())
                return;
            if (other.points.insert(p).second) changed.insert(to);
        };
        for (const Segment& s : t.segments) {
            for (const NodeId p : nodes_on(t, s.ends[0], s.ends[1]))
                hand(s.other, p);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const NodeId a = t.corners[i], b = t.corners[(i + 1) % 3];
            const auto on = nodes_on(t, a, b);
            if (on.empty()) continue;
            for (const std::int32_t other : of_edge_.at(unordered(a, b))) {
                for (const NodeId p : on)
                    hand(other, p);
            }
        }
    }
}

void Overlay::divide(const Progress* progress) {
    exchange_segments();
    spread_points(progress);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        if (progress != nullptr && (t & 0xff) == 0) progress->check();
        if (triangles_[t].turned != 0) find_regions(static_cast<std::int32_t>(t));
    }
}

}  // namespace realmodel::cutting
