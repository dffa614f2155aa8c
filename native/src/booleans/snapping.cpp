// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/snapping.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "arrangement/polygons.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/ulp.hpp"

namespace realmodel::booleans {

using arrangement::cross;
using arrangement::dot;
using arrangement::minus;
using Position = exact::SpacePosition;

namespace {

Edge edge_of(SpacePointId a, SpacePointId b) {
    return {std::min(a, b), std::max(a, b)};
}

Position along(const Position& a, const Position& b, double t) {
    Position p;
    for (std::size_t k = 0; k < 3; ++k)
        p[k] = a[k] + t * (b[k] - a[k]);
    return p;
}

double length(const Position& v) {
    return std::sqrt(dot(v, v));
}

bool has(const Corners& corners, SpacePointId p) {
    return std::find(corners.begin(), corners.end(), p) != corners.end();
}

std::array<Edge, 3> edges_of(const Corners& c) {
    return {edge_of(c[0], c[1]), edge_of(c[1], c[2]), edge_of(c[2], c[0])};
}

/// Pieces of one triangle that have been folded upon each other go, two and two.
void cancel_folds(std::vector<Piece>& pieces) {
    std::map<Corners, std::array<std::vector<std::size_t>, 2>> by_corners;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const auto [corners, is_odd] = in_order(pieces[i].corners);
        by_corners[corners][is_odd ? 1 : 0].push_back(i);
    }
    std::vector<std::uint8_t> goes(pieces.size(), 0);
    for (const auto& [corners, found] : by_corners) {
        for (std::size_t k = 0; k < std::min(found[0].size(), found[1].size()); ++k)
            goes[found[0][k]] = goes[found[1][k]] = 1;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (goes[i] == 0) pieces[kept++] = pieces[i];
    }
    pieces.resize(kept);
}

}  // namespace

Snapping::Snapping(Pieces& pieces, std::vector<FacetPair>&& pairs, double ulps)
    : pieces_(pieces), pairs_(std::move(pairs)), ulps_(ulps) {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    is_near_.assign(pairs_.size(), false);
    // what gets new vertices hands them on to all that is near it, so that layers that lie upon one
    // another are divided alike
    std::vector<Corners> facets;
    for (const FacetPair& pair : pairs_)
        facets.insert(facets.end(), pair.begin(), pair.end());
    std::set<Corners> known;
    std::set<FacetPair> done;
    while (!facets.empty()) {
        std::vector<FacetPair> near = pairs_near(facets);
        facets.clear();
        std::erase_if(near, [&](const FacetPair& pair) { return !done.insert(pair).second; });
        for (const FacetPair& pair : near) {
            for (const Corners& corners : pair) {
                if (!known.insert(corners).second) continue;
                for (const SpacePointId p : corners)
                    add_vertex(p);
            }
        }
        for (const FacetPair& pair : near) {
            const bool merges = find_merges(pair);
            if (!find_near(pair) && !merges) continue;
            facets.insert(facets.end(), pair.begin(), pair.end());
            const auto own = std::lower_bound(pairs_.begin(), pairs_.end(), pair);
            if (own != pairs_.end() && *own == pair)
                is_near_[static_cast<std::size_t>(own - pairs_.begin())] = true;
        }
    }
    merge_vertices();
    if (!merged_.empty()) {  // the others are found again, with the vertices that remain
        on_edges_.clear();
        additions_.clear();
    } else {
        spread_points();
    }
    order_points();
}

Snapping::Snapping(Pieces& pieces, const std::vector<Corners>& flat) : pieces_(pieces) {
    for (const Corners& t : flat) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Edge edge = edge_of(t[k], t[(k + 1) % 3]);
            if (is_between(t[(k + 2) % 3], edge)) on_edges_[edge].push_back(t[(k + 2) % 3]);
        }
    }
    order_points();
}

double Snapping::distance_of(const FacetPair& pair) const {
    double largest = 0;
    for (const Corners& corners : pair) {
        for (const SpacePointId p : corners) {
            for (const double x : pieces_.points.rounded(p))
                largest = std::max(largest, std::abs(x));
        }
    }
    return ulps_ * ulp(largest);
}

SpacePointId Snapping::merged(SpacePointId p) const {
    const auto found = merged_.find(p);
    return found == merged_.end() ? p : found->second;
}

/// Triangles with all that come near them.
std::vector<FacetPair> Snapping::pairs_near(std::vector<Corners>& facets) {
    std::sort(facets.begin(), facets.end());
    facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
    std::vector<FacetPair> pairs;
    for (const Corners& facet : facets) {
        if (!asked_.insert(facet).second) continue;
        spatial::Box box = pieces_.box(facet);
        box.widen(distance_of({facet, facet}));
        pieces_.find_inputs(box, [&](std::int32_t input) {
            for (const Piece& piece : pieces_.of(input)) {
                const Corners other = in_order(piece.corners).first;
                if (other == facet || !box.meets(pieces_.box(other))) continue;
                pairs.push_back({std::min(facet, other), std::max(facet, other)});
            }
        });
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

void Snapping::add_vertex(SpacePointId p) {
    if (vertices_.insert(p).second) by_x_.emplace(pieces_.points.rounded(p)[0], p);
}

/// Notes vertices that are to become one.
bool Snapping::find_merges(const FacetPair& pair) {
    const double within = distance_of(pair);
    std::array<SpacePointId, 6> all;
    std::copy(pair[0].begin(), pair[0].end(), all.begin());
    std::copy(pair[1].begin(), pair[1].end(), all.begin() + 3);
    bool found = false;
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = i + 1; j < 6; ++j) {
            if (all[i] == all[j] || length(minus(pieces_.points.rounded(all[i]),
                                                 pieces_.points.rounded(all[j]))) > within)
                continue;
            same_.push_back(edge_of(all[i], all[j]));
            found = true;
        }
    }
    return found;
}

/// Of vertices that become one the first stands for all: the inputs' come before new ones.
void Snapping::merge_vertices() {
    std::vector<SpacePointId> vertices;
    for (const Edge& pair : same_)
        vertices.insert(vertices.end(), pair.begin(), pair.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const auto number = [&](SpacePointId p) {
        return static_cast<std::int32_t>(std::lower_bound(vertices.begin(), vertices.end(), p) -
                                         vertices.begin());
    };
    DisjointSets sets(vertices.size());
    for (const Edge& pair : same_)
        sets.join(number(pair[0]), number(pair[1]));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const auto to = index(sets.find(static_cast<std::int32_t>(i)));
        if (to == i) continue;
        merged_[vertices[i]] = vertices[to];
        moved_ = std::max(moved_, length(minus(pieces_.points.rounded(vertices[i]),
                                               pieces_.points.rounded(vertices[to]))));
    }
}

bool Snapping::is_between(SpacePointId p, const Edge& edge) const {
    const std::size_t axis = edge_axis(pieces_.points, edge[0], edge[1]);
    const double x = pieces_.points.rounded(p)[axis], from = pieces_.points.rounded(edge[0])[axis],
                 to = pieces_.points.rounded(edge[1])[axis];
    return std::min(from, to) < x && x < std::max(from, to);
}

bool Snapping::is_near_edge(SpacePointId p, const Edge& edge, double within) const {
    if (p == edge[0] || p == edge[1] || !is_between(p, edge)) return false;
    const Position &at = pieces_.points.rounded(p), &a = pieces_.points.rounded(edge[0]),
                   &b = pieces_.points.rounded(edge[1]);
    const Position line = minus(b, a);
    const double share = std::clamp(dot(minus(at, a), line) / dot(line, line), 0.0, 1.0);
    return length(minus(at, along(a, b, share))) <= within;
}

/// Whether a vertex is near edges of a triangle, which then get it.
bool Snapping::find_near_edges(SpacePointId p, const Corners& t, double within) {
    bool found = false;
    for (const Edge& edge : edges_of(t)) {
        if (!is_near_edge(p, edge, within)) continue;
        on_edges_[edge].push_back(p);
        found = true;
    }
    return found;
}

/// Two edges that pass each other get a common vertex, unless the end of one is near the other:
/// then that gets this end, and a new vertex would only make more edges that are nearly parallel.
void Snapping::find_crossing(const Edge& e, const Edge& f, double within, bool& found) {
    for (std::size_t k = 0; k < 2; ++k) {
        if (is_near_edge(e[k], f, within) || is_near_edge(f[k], e, within)) return;
    }
    const auto& points = pieces_.points;
    const Position &a = points.rounded(e[0]), &b = points.rounded(e[1]), &c = points.rounded(f[0]),
                   &d = points.rounded(f[1]);
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
    const SpacePointId p = vertex_near(along(on_e, on_f, 0.5), within);
    for (const Edge& edge : {e, f}) {
        if (p == edge[0] || p == edge[1] || !is_between(p, edge)) continue;
        on_edges_[edge].push_back(p);
        found = true;
    }
}

/// The nearest known vertex within a distance, or a new one.
SpacePointId Snapping::vertex_near(const Position& at, double within) {
    SpacePointId nearest = kNone;
    double least = within;
    for (auto next = by_x_.lower_bound(at[0] - within);
         next != by_x_.end() && next->first <= at[0] + within; ++next) {
        const double distance = length(minus(pieces_.points.rounded(next->second), at));
        if (distance > least || (distance == least && nearest.has_value())) continue;
        least = distance;
        nearest = next->second;
    }
    if (nearest.has_value()) return nearest;
    nearest = pieces_.points.add(at);
    by_x_.emplace(pieces_.points.rounded(nearest)[0], nearest);
    return nearest;
}

/// Whether a vertex is near the inside of a triangle.
bool Snapping::is_over(SpacePointId p, const Corners& t, double within) const {
    const Position& a = pieces_.points.rounded(t[0]);
    const Position u = minus(pieces_.points.rounded(t[1]), a),
                   v = minus(pieces_.points.rounded(t[2]), a),
                   w = minus(pieces_.points.rounded(p), a);
    const Position normal = cross(u, v);
    const double size = dot(normal, normal);
    if (!(size > 0) || std::abs(dot(normal, w)) > within * std::sqrt(size)) return false;
    // the shares of the corners
    const double s = dot(cross(w, v), normal) / size, r = dot(cross(u, w), normal) / size;
    return s > 0 && r > 0 && s + r < 1;
}

/// Points on the edges of a triangle go to all that is near it, until all have them.
void Snapping::spread_points() {
    std::map<Corners, std::set<SpacePointId>> placed;
    for (bool changed = true; changed;) {
        changed = false;
        for (auto& [t, addition] : additions_) {
            auto& own = placed[t];
            for (const Corners& near : addition.near) {
                const double within = distance_of({t, near});
                for (const Edge& edge : edges_of(near)) {
                    const auto on = on_edges_.find(edge);
                    if (on == on_edges_.end()) continue;
                    for (std::size_t i = 0; i < on->second.size(); ++i) {
                        const SpacePointId p = on->second[i];
                        if (has(t, p) || !own.insert(p).second) continue;
                        changed = true;
                        if (find_near_edges(p, t, within)) continue;
                        if (is_over(p, t, within)) addition.within.push_back(p);
                    }
                }
            }
        }
    }
}

bool Snapping::find_near(const FacetPair& pair) {
    const double within = distance_of(pair);
    bool found = false, at_edges = false;
    for (std::size_t k = 0; k < 2; ++k) {
        const Corners &own = pair[k], &other = pair[1 - k];
        for (const SpacePointId p : own) {
            // a corner near the edge across it: a triangle of no width
            if (find_near_edges(p, own, within)) found = true;
            if (has(other, p)) continue;
            if (find_near_edges(p, other, within)) {
                at_edges = true;
                continue;
            }
            if (!is_over(p, other, within)) continue;
            additions_[other].within.push_back(p);
            found = true;
        }
    }
    for (const Edge& e : edges_of(pair[0])) {
        for (const Edge& f : edges_of(pair[1])) {
            if (e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1]) continue;
            // one place for two edges, whichever triangles they are of
            find_crossing(std::min(e, f), std::max(e, f), within, found);
        }
    }
    found = found || at_edges;
    if (found) {
        additions_[pair[0]].near.push_back(pair[1]);
        additions_[pair[1]].near.push_back(pair[0]);
        moved_ = std::max(moved_, within);
    }
    return found;
}

void Snapping::order_points() {
    for (auto& [edge, on] : on_edges_) {
        const std::size_t axis = edge_axis(pieces_.points, edge[0], edge[1]);
        const auto& points = pieces_.points;
        const bool grows = points.rounded(edge[0])[axis] < points.rounded(edge[1])[axis];
        const auto at = [&](SpacePointId p) {
            return grows ? points.rounded(p)[axis] : -points.rounded(p)[axis];
        };
        std::sort(on.begin(), on.end(), [&](SpacePointId p, SpacePointId q) {
            return std::pair(at(p), p) < std::pair(at(q), q);
        });
        on.erase(std::unique(on.begin(), on.end(),
                             [&](SpacePointId p, SpacePointId q) { return at(p) == at(q); }),
                 on.end());
    }
    for (auto& [corners, addition] : additions_) {
        auto& within = addition.within;
        std::sort(within.begin(), within.end());
        within.erase(std::unique(within.begin(), within.end()), within.end());
        auto& near = addition.near;
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
    }
}

std::vector<SpacePointId> Snapping::points_between(SpacePointId from, SpacePointId to) const {
    const auto found = on_edges_.find(edge_of(from, to));
    if (found == on_edges_.end()) return {};
    std::vector<SpacePointId> on = found->second;
    if (to < from) std::reverse(on.begin(), on.end());
    return on;
}

std::vector<Corners> Snapping::divided(const Corners& corners) const {
    FacetPoints facet{corners, {}, {}, {}};
    std::set<SpacePointId> all(corners.begin(), corners.end());
    for (std::size_t k = 0; k < 3; ++k) {
        facet.on_edges[k] = points_between(corners[k], corners[(k + 1) % 3]);
        all.insert(facet.on_edges[k].begin(), facet.on_edges[k].end());
    }
    if (const auto found = additions_.find(corners); found != additions_.end()) {
        facet.within = found->second.within;
        all.insert(facet.within.begin(), facet.within.end());
        for (const Corners& near : found->second.near) {
            for (const Edge& edge : edges_of(near)) {
                SpacePointId last = edge[0];
                const auto want = [&](SpacePointId next) {
                    if (all.contains(last) && all.contains(next))
                        facet.wanted.push_back(edge_of(last, next));
                    last = next;
                };
                for (const SpacePointId p : points_between(edge[0], edge[1]))
                    want(p);
                want(edge[1]);
            }
        }
        std::sort(facet.wanted.begin(), facet.wanted.end());
        facet.wanted.erase(std::unique(facet.wanted.begin(), facet.wanted.end()),
                           facet.wanted.end());
    }
    return booleans::divided(pieces_.points, facet);
}

std::vector<std::int32_t> Snapping::apply(int threads, const Progress* progress) {
    // what may have one of these vertices, edges or triangles
    std::vector<spatial::Box> places;
    for (const auto& [from, to] : merged_)
        places.emplace_back().include(pieces_.points.rounded(from));
    for (const auto& [edge, on] : on_edges_) {
        spatial::Box& box = places.emplace_back();
        for (const SpacePointId p : edge)
            box.include(pieces_.points.rounded(p));
    }
    for (const auto& [corners, addition] : additions_) {
        if (!addition.within.empty()) places.push_back(pieces_.box(corners));
    }
    pieces_.moved_by(moved_ + 4 * ulp(pieces_.largest_coordinate()));
    std::vector<std::vector<std::int32_t>> found(places.size());
    parallel_ranges(places.size(), 64, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            pieces_.find_inputs(places[i], [&](std::int32_t input) { found[i].push_back(input); });
    });
    std::vector<std::int32_t> inputs;
    for (const auto& some : found)
        inputs.insert(inputs.end(), some.begin(), some.end());
    std::sort(inputs.begin(), inputs.end());
    inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    std::vector<std::vector<Piece>> made(inputs.size());
    std::vector<std::uint8_t> is_changed(inputs.size(), 0);
    parallel_ranges(inputs.size(), 16, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (const Piece& piece : pieces_.of(inputs[i])) {
                Piece own = piece;
                for (SpacePointId& p : own.corners)
                    p = merged(p);
                if (own.corners != piece.corners) {
                    own.is_fresh = true;
                    is_changed[i] = 1;
                }
                if (has_equal_corners(own.corners)) continue;
                const auto [corners, is_odd] = in_order(own.corners);
                const auto addition = additions_.find(corners);
                bool gets_more = addition != additions_.end() && !addition->second.within.empty();
                for (const Edge& edge : edges_of(corners))
                    gets_more = gets_more || on_edges_.contains(edge);
                if (!gets_more) {
                    made[i].push_back(own);
                    continue;
                }
                is_changed[i] = 1;
                for (Corners t : divided(corners)) {
                    if (is_odd) std::swap(t[1], t[2]);
                    if (!has_equal_corners(t)) made[i].push_back({t, true});
                }
            }
        }
    });
    std::vector<std::int32_t> changed;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (is_changed[i] == 0) continue;
        cancel_folds(made[i]);
        pieces_.replace(inputs[i], std::move(made[i]));
        changed.push_back(inputs[i]);
    }
    return changed;
}

}  // namespace realmodel::booleans
