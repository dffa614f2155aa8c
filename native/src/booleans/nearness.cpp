// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/nearness.hpp"

#include <algorithm>
#include <cmath>

#include "arrangement/polygons.hpp"
#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "booleans/triangle_pieces.hpp"

namespace realmodel::booleans {

using Position = exact::SpacePosition;

namespace {

/// A triangle that reaches far makes no more of a small one near than this share of a coordinate.
constexpr double kMostOfShared = 1e-9;

Position along(const Position& a, const Position& b, double t) {
    return moved(a, t, minus(b, a));
}

/// Whether the boxes of two edges are within a distance.
bool are_boxes_near(const std::array<Position, 2>& e, const std::array<Position, 2>& f,
                    double within) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::max(e[0][k], e[1][k]) + within < std::min(f[0][k], f[1][k]) ||
            std::max(f[0][k], f[1][k]) + within < std::min(e[0][k], e[1][k]))
            return false;
    }
    return true;
}

}  // namespace

FacetPair pair_of(TriangleCorners one, TriangleCorners other) {
    one = in_order(one).first;
    other = in_order(other).first;
    return other < one ? FacetPair{other, one} : FacetPair{one, other};
}

void NearFeatures::take(NearFeatures& other) {
    const auto move = [](auto& to, auto& from) {
        to.insert(to.end(), from.begin(), from.end());
        from.clear();
    };
    move(same, other.same);
    move(on_edges, other.on_edges);
    move(over, other.over);
    move(crossings, other.crossings);
}

void NearFeatures::make_unique() {
    sort_unique(same);
    sort_unique(on_edges);
    sort_unique(over);
    sort_unique(crossings);
}

double Nearness::distance_at(double coordinate) const {
    return ulps_ * ulp(coordinate);
}

double Nearness::distance_of(const FacetPair& pair) const {
    // what both reach, and what one of them does
    double shared = 0, largest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto reach = [&](const TriangleCorners& corners) {
            double farthest = 0;
            for (const SpacePointId p : corners)
                farthest = std::max(farthest, std::abs(points_.rounded(p)[axis]));
            return farthest;
        };
        const auto [lesser, greater] = std::minmax({reach(pair[0]), reach(pair[1])});
        shared = std::max(shared, lesser);
        largest = std::max(largest, greater);
    }
    return std::min(distance_at(largest), std::max(distance_at(shared), kMostOfShared * shared));
}

bool Nearness::is_between(SpacePointId p, const SpaceEdge& edge) const {
    const std::size_t axis = edge_axis(points_, edge[0], edge[1]);
    const double x = points_.rounded(p)[axis], from = points_.rounded(edge[0])[axis],
                 to = points_.rounded(edge[1])[axis];
    return std::min(from, to) < x && x < std::max(from, to);
}

bool Nearness::is_near_edge(SpacePointId p, const SpaceEdge& edge, double within) const {
    if (p == edge[0] || p == edge[1]) return false;
    const Position &at = points_.rounded(p), &a = points_.rounded(edge[0]),
                   &b = points_.rounded(edge[1]);
    if (!are_boxes_near({at, at}, {a, b}, within) || !is_between(p, edge)) return false;
    const Position line = minus(b, a);
    const double share = std::clamp(dot(minus(at, a), line) / dot(line, line), 0.0, 1.0);
    return length(minus(at, along(a, b, share))) <= within;
}

/// Whether a vertex is near the inside of a triangle.
bool Nearness::is_over(SpacePointId p, const TriangleCorners& t, double within) const {
    const Position& a = points_.rounded(t[0]);
    const Position u = minus(points_.rounded(t[1]), a), v = minus(points_.rounded(t[2]), a),
                   w = minus(points_.rounded(p), a);
    const Position normal = cross(u, v);
    const double size = dot(normal, normal);
    if (!(size > 0) || std::abs(dot(normal, w)) > within * std::sqrt(size)) return false;
    // the shares of the corners
    const double s = dot(cross(w, v), normal) / size, r = dot(cross(u, w), normal) / size;
    return s > 0 && r > 0 && s + r < 1;
}

void Nearness::find_same(const FacetPair& pair, double within, NearFeatures& features) const {
    std::array<SpacePointId, 6> all;
    std::copy(pair[0].begin(), pair[0].end(), all.begin());
    std::copy(pair[1].begin(), pair[1].end(), all.begin() + 3);
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = i + 1; j < 6; ++j) {
            if (all[i] == all[j]) continue;
            const Position &p = points_.rounded(all[i]), &q = points_.rounded(all[j]);
            if (std::abs(p[0] - q[0]) > within || length(minus(p, q)) > within) continue;
            features.same.push_back(unordered(all[i], all[j]));
        }
    }
}

/// Two edges that pass each other get a common vertex, unless the end of one is near the other:
/// then that gets this end, and a new vertex would only make more edges that are nearly parallel.
void Nearness::find_crossing(const SpaceEdge& e, const SpaceEdge& f, double within,
                             NearFeatures& features) const {
    const Position &a = points_.rounded(e[0]), &b = points_.rounded(e[1]),
                   &c = points_.rounded(f[0]), &d = points_.rounded(f[1]);
    if (!are_boxes_near({a, b}, {c, d}, within)) return;
    for (std::size_t k = 0; k < 2; ++k) {
        if (is_near_edge(e[k], f, within) || is_near_edge(f[k], e, within)) return;
    }
    // where edges are nearly parallel the place is uncertain along them, but not across
    const Position u = minus(b, a), v = minus(d, c), w = minus(c, a), normal = cross(u, v);
    const double size = dot(normal, normal);
    if (!(size > 0)) return;
    const double s = dot(cross(w, v), normal) / size;
    if (!(s > 0 && s < 1)) return;
    const Position on_e = along(a, b, s);
    const double r = dot(minus(on_e, c), v) / dot(v, v);
    if (!(r > 0 && r < 1)) return;
    const Position on_f = along(c, d, r);
    if (length(minus(on_e, on_f)) > within) return;
    features.crossings.push_back({e, f, along(on_e, on_f, 0.5), within});
}

void Nearness::find(const FacetPair& pair, NearFeatures& features) const {
    const double within = distance_of(pair);
    find_same(pair, within, features);
    // whether a vertex is near edges of a triangle, which then get it
    const auto find_near_edges = [&](SpacePointId p, const TriangleCorners& t) {
        bool is_near = false;
        for (const SpaceEdge& edge : edges_of(t)) {
            if (!is_near_edge(p, edge, within)) continue;
            features.on_edges.emplace_back(edge, p);
            is_near = true;
        }
        return is_near;
    };
    for (std::size_t k = 0; k < 2; ++k) {
        const TriangleCorners &t = pair[k], &other = pair[1 - k];
        for (const SpacePointId p : t) {
            find_near_edges(p, t);  // a corner near the edge across it: a triangle of no width
            if (has(other, p) || find_near_edges(p, other) || !is_over(p, other, within)) continue;
            features.over.emplace_back(other, p);
        }
    }
    for (const SpaceEdge& e : edges_of(pair[0])) {
        for (const SpaceEdge& f : edges_of(pair[1])) {
            if (e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) continue;
            // one place for two edges, whichever triangles they are of
            find_crossing(std::min(e, f), std::max(e, f), within, features);
        }
    }
}

/// Whether what a triangle has on one side of the plane of another is near that plane.
bool Nearness::passes_little(const TriangleCorners& triangle, const TriangleCorners& plane,
                             double within) const {
    const Position& a = points_.rounded(plane[0]);
    const Position normal =
        cross(minus(points_.rounded(plane[1]), a), minus(points_.rounded(plane[2]), a));
    double above = 0, below = 0;
    for (const SpacePointId p : triangle) {
        if (has(plane, p)) continue;
        const double height = dot(normal, minus(points_.rounded(p), a));
        above = std::max(above, height);
        below = std::max(below, -height);
    }
    return std::min(above, below) <= within * length(normal);
}

bool Nearness::is_shallow(const FacetPair& pair) const {
    const double within = distance_of(pair);
    return passes_little(pair[0], pair[1], within) || passes_little(pair[1], pair[0], within);
}

}  // namespace realmodel::booleans
