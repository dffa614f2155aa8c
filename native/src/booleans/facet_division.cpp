// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facet_division.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "arrangement/polygons.hpp"
#include "base/parallel.hpp"
#include "exact/space_points.hpp"
#include "meshing/flat_mesh.hpp"

namespace realmodel::booleans {

namespace {

using meshing::HalfEdge;

/// Triangles of a polygon of any shape: a fan from its least corner. Those without extent are left
/// out.
void add_fan(const std::vector<SpacePointId>& loop, std::vector<TriangleCorners>& triangles) {
    const auto least =
        static_cast<std::size_t>(std::min_element(loop.begin(), loop.end()) - loop.begin());
    const auto at = [&](std::size_t i) { return loop[(least + i) % loop.size()]; };
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        const TriangleCorners t{at(0), at(i), at(i + 1)};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
}

/// A triangulation of one triangle, in which points are where they would be if they lay on it. Its
/// point numbers are its own; its fixed edges stay.
class FacetDivision {
public:
    FacetDivision(const SpacePoints& points, const FacetPoints& facet, Progress* progress)
        : global_(points), progress_(progress) {
        TriangleCorners local;
        for (std::size_t k = 0; k < 3; ++k)
            local[k] = enter(places_.add(points.rounded(facet.corners[k])), facet.corners[k]);
        find_best_axis(facet.corners);
        if (facing_ == 0) return;
        note_corners(mesh_.add_triangle({local[0].number(), local[1].number(), local[2].number()}));
        for (std::size_t k = 0; k < 3; ++k)
            divide_edge(local[k], local[(k + 1) % 3], facet.on_edges[k]);
        for (const SpacePointId p : facet.within)
            insert(p, local);
        for (const SpaceEdge& edge : facet.wanted)
            insert_edge(edge);
        improve();
        assert(is_triangulation(facet));
    }

    bool has_area() const { return facing_ != 0; }
    std::vector<TriangleCorners> result() const {
        std::vector<TriangleCorners> triangles;
        for (const auto& [a, b, c] : mesh_.corners)
            triangles.push_back(
                {name(SpacePointId(a)), name(SpacePointId(b)), name(SpacePointId(c))});
        return triangles;
    }

private:
    /// Whether neighbors know each other, and triangles are as many as points on edges and two for
    /// each within, and one.
    bool is_triangulation(const FacetPoints& facet) const {
        std::size_t outer = 0, points = 0;
        bool agrees = true;
        mesh_.for_each_edge([&](HalfEdge edge) {
            const HalfEdge other = mesh_.twin(edge);
            if (other.is_none()) {
                ++outer;
            } else {
                agrees = agrees && mesh_.twin(other) == edge && from(edge) == to(other) &&
                         to(edge) == from(other);
            }
        });
        for (const SpacePointId p : names_)
            points += p.has_value() ? 1 : 0;
        return agrees &&
               outer <= 3 + facet.on_edges[0].size() + facet.on_edges[1].size() +
                            facet.on_edges[2].size() &&
               mesh_.corners.size() == 2 * points - outer - 2;
    }

    /// The view along the axis in which the triangle is largest, among those in which it has an
    /// area, if there are any.
    void find_best_axis(const TriangleCorners& corners) {
        double largest = -1;
        const Vec3 normal = triangle_normal(
            global_.rounded(corners[0]), global_.rounded(corners[1]), global_.rounded(corners[2]));
        const TriangleCorners local{SpacePointId(0), SpacePointId(1), SpacePointId(2)};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double area = std::abs(normal[axis]);
            if (area <= largest) continue;
            const int turn = exact::orient2d(places_, axis, local[0], local[1], local[2]);
            if (turn == 0) continue;
            largest = area;
            axis_ = axis;
            facing_ = turn;
        }
    }
    /// Notes which point a place is of. kNone where it is another's.
    SpacePointId enter(SpacePointId place, SpacePointId p) {
        names_.resize(std::max(names_.size(), index(place) + 1), kNone);
        SpacePointId& known = names_[index(place)];
        if (known.has_value() && known != p) return kNone;
        known = p;
        by_name_.emplace(p, place);
        return place;
    }
    SpacePointId name(SpacePointId place) const { return names_[index(place)]; }
    SpacePointId place_of(SpacePointId p) const {
        const auto at = by_name_.find(p);
        return at == by_name_.end() ? SpacePointId(kNone) : at->second;
    }
    int turn(SpacePointId a, SpacePointId b, SpacePointId c) const {
        return facing_ * exact::orient2d(places_, axis_, a, b, c);
    }

    SpacePointId from(HalfEdge edge) const { return SpacePointId(mesh_.from(edge)); }
    SpacePointId to(HalfEdge edge) const { return SpacePointId(mesh_.to(edge)); }
    SpacePointId apex(HalfEdge edge) const { return SpacePointId(mesh_.apex(edge)); }
    void note_corners(std::int32_t triangle) {
        for (int k = 0; k < 3; ++k) {
            const HalfEdge edge(triangle, k);
            around_.resize(std::max(around_.size(), index(from(edge)) + 1));
            around_[index(from(edge))] = edge;
        }
    }
    /// The edge from a to b as the triangle to its left has it; none where there is none.
    HalfEdge left_of(SpacePointId a, SpacePointId b) const {
        HalfEdge left;
        mesh_.visit_star(around_[index(a)], [&](HalfEdge edge) {
            if (left.is_none() && to(edge) == b) left = edge;
        });
        return left;
    }
    /// Divides the triangles beside an edge at a point of it; of the first one the part before the
    /// point keeps its number.
    /// @return the first edge of the other part
    HalfEdge split(HalfEdge edge, SpacePointId p) {
        const HalfEdge other = mesh_.twin(edge);
        const auto rest = static_cast<std::int32_t>(mesh_.corners.size());
        mesh_.divide(edge, p.number());
        note_corners(edge.triangle());
        note_corners(rest);
        if (!other.is_none()) {
            note_corners(other.triangle());
            note_corners(rest + 1);
        }
        return {rest, 0};
    }

    void divide_edge(SpacePointId from, SpacePointId to, const std::vector<SpacePointId>& between) {
        const std::size_t axis = edge_axis(global_, name(from), name(to));
        const SpacePointId end_of[2] = {from, to};
        HalfEdge edge = left_of(from, to);
        for (const SpacePointId p : between) {
            if (progress_ != nullptr) progress_->check();
            const SpacePointId place = enter(
                places_.projected(axis, places_.add(global_.rounded(p)), end_of[0], end_of[1]), p);
            if (!place.has_value()) continue;
            assert(!edge.is_none() && this->to(edge) == to);
            edge = split(edge, place);
        }
    }

    /// The triangle that has a place, and the turns of its edges and that: a walk towards it
    /// (remembering where it came from), and all triangles in their order where that goes round.
    std::int32_t triangle_with(SpacePointId place, std::array<int, 3>& turns) const {
        const auto has_place = [&](std::int32_t t) {
            for (int k = 0; k < 3; ++k)
                turns[index(k)] = turn(from({t, k}), to({t, k}), place);
            return *std::min_element(turns.begin(), turns.end()) >= 0;
        };
        const std::size_t count = mesh_.corners.size();
        auto t = static_cast<std::int32_t>(count) - 1;
        for (std::size_t step = 0; step < count && t >= 0; ++step) {
            if (has_place(t)) return t;
            const auto least =
                std::find_if(turns.begin(), turns.end(), [](int n) { return n < 0; });
            t = mesh_.twin({t, static_cast<int>(least - turns.begin())}).triangle();
        }
        for (t = 0; index(t) < count; ++t) {
            if (has_place(t)) return t;
        }
        return -1;
    }

    void insert(SpacePointId p, const TriangleCorners& corners) {
        if (progress_ != nullptr) progress_->check();
        if (place_of(p).has_value()) return;
        const SpacePointId raw = places_.add(global_.rounded(p));
        const SpacePointId place =
            places_.projected(axis_, raw, corners[0], corners[1], corners[2]);
        if (index(place) < names_.size() && name(place).has_value()) return;
        std::array<int, 3> turns{};
        const std::int32_t triangle = triangle_with(place, turns);
        if (triangle < 0) return;  // outside
        const auto zero = std::find(turns.begin(), turns.end(), 0);
        if (zero != turns.end()) {
            const HalfEdge edge(triangle, static_cast<int>(zero - turns.begin()));
            if (mesh_.is_border(edge)) return;
            enter(place, p);
            split(edge, place);
            return;
        }
        enter(place, p);
        const auto added = static_cast<std::int32_t>(mesh_.corners.size());
        mesh_.divide(triangle, place.number());
        for (const std::int32_t t : {triangle, added, added + 1})
            note_corners(t);
    }

    /// Exchanges a diagonal with the other one of its quadrilateral, if that is convex.
    bool flip(HalfEdge left) {
        const HalfEdge right = mesh_.twin(left);
        if (right.is_none()) return false;
        const SpacePointId a = from(left), b = to(left), c = apex(left), d = apex(right);
        if (turn(d, b, c) <= 0 || turn(c, a, d) <= 0) return false;
        mesh_.flip(left);
        // what comes first decides where several edges could be flipped
        mesh_.rotate(left.triangle(), 2);
        mesh_.rotate(right.triangle(), 1);
        note_corners(left.triangle());
        note_corners(right.triangle());
        return true;
    }
    void keep(HalfEdge edge) {
        mesh_.fix(edge);
        if (!mesh_.is_border(edge)) mesh_.fix(mesh_.twin(edge));
    }

    /// The edges that the line between two corners crosses, from one to the other; nothing where it
    /// runs over a point or crosses an edge that is kept.
    std::optional<std::vector<SpaceEdge>> crossed_edges(SpacePointId p, SpacePointId q) const {
        HalfEdge crossed;
        bool is_free = true;
        mesh_.visit_star(around_[index(p)], [&](HalfEdge edge) {
            if (!is_free || !crossed.is_none()) return;
            const SpacePointId b = to(edge), c = apex(edge);
            const int to_b = turn(p, q, b), to_c = turn(p, q, c);
            for (const auto& [v, side_of_v] : {std::pair(b, to_b), std::pair(c, to_c)})
                is_free = is_free && (side_of_v != 0 || !is_between(v, p, q));
            if (to_b < 0 && to_c > 0) crossed = edge.next();
        });
        if (!is_free || crossed.is_none()) return std::nullopt;
        std::vector<SpaceEdge> edges;
        for (;;) {
            if (mesh_.is_fixed(crossed)) return std::nullopt;
            edges.push_back({from(crossed), to(crossed)});
            const HalfEdge next = mesh_.twin(crossed);
            if (next.is_none()) return std::nullopt;
            const SpacePointId tip = apex(next);
            if (tip == q) return edges;
            const int side = turn(p, q, tip);
            if (side == 0) return std::nullopt;
            // of the two edges at the tip the one whose other end is on the other side
            crossed = side > 0 ? next.next() : next.prev();
        }
    }
    bool is_between(SpacePointId v, SpacePointId p, SpacePointId q) const {
        return v != q && exact::compare(places_, p, v) * exact::compare(places_, v, q) > 0;
    }

    /// Flips what crosses an edge until nothing does (S. W. Sloan, "A fast algorithm for generating
    /// constrained Delaunay triangulations", 1993). Nothing where it runs over a point or crosses
    /// an edge that is kept.
    void insert_edge(const SpaceEdge& edge) {
        if (progress_ != nullptr) progress_->check();
        const SpacePointId p = place_of(edge[0]), q = place_of(edge[1]);
        if (!p.has_value() || !q.has_value() || p == q) return;
        for (const auto& [from, to] : {std::pair(p, q), std::pair(q, p)}) {
            const HalfEdge existing = left_of(from, to);
            if (!existing.is_none()) return keep(existing);
        }
        auto crossed = crossed_edges(p, q);
        if (!crossed) return;
        const auto is_crossed_by = [&](SpacePointId a, SpacePointId b) {
            if (a == p || a == q || b == p || b == q) return false;
            return turn(p, q, a) * turn(p, q, b) < 0 && turn(a, b, p) * turn(a, b, q) < 0;
        };
        const std::size_t most = 100 * crossed->size() + 10000;
        for (std::size_t i = 0; i < crossed->size() && i < most; ++i) {
            const auto [a, b] = (*crossed)[i];
            const HalfEdge left = left_of(a, b);
            const SpacePointId c = apex(left), d = apex(mesh_.twin(left));
            if (!flip(left)) {
                crossed->push_back({a, b});
            } else if (is_crossed_by(c, d)) {
                crossed->push_back({c, d});
            }
        }
        const HalfEdge made = left_of(p, q);
        if (!made.is_none()) keep(made);
    }
    /// The cotangent of the angle at a point, between two others.
    double cotangent(SpacePointId at, SpacePointId from, SpacePointId to) const {
        const auto &p = global_.rounded(at), &q = global_.rounded(from), &r = global_.rounded(to);
        const Vec3 u = minus(q, p), v = minus(r, p);
        return dot(u, v) / length(cross(u, v));
    }
    /// Whether of a quadrilateral's diagonals that from a to b is against Delaunay's rule: the sum
    /// of the angles at c and d is more than half a turn. The same for the same four points in
    /// whichever triangles, and seen along whichever axis.
    bool is_worse(SpacePointId a, SpacePointId b, SpacePointId c, SpacePointId d) const {
        constexpr double kTie = 1e-6;
        if (b < a) std::swap(a, b);
        if (d < c) std::swap(c, d);
        const bool other_first = c < a;
        if (other_first) {
            std::swap(a, c);
            std::swap(b, d);
        }
        const double sum = cotangent(c, a, b) + cotangent(d, a, b);
        return (sum < -kTie) != other_first;
    }
    /// Flips edges until none has a point across it within its circle (C. L. Lawson, 1977): so
    /// triangles near one another that have the same points get the same edges.
    void improve() {
        for (std::size_t pass = 0; pass < 64; ++pass) {
            bool changed = false;
            mesh_.for_each_edge([&](HalfEdge e) {
                if (e.index() == 0) poll(progress_, index(e.triangle()));
                const HalfEdge other = mesh_.twin(e);
                if (other.is_none() || mesh_.is_fixed(e)) return;
                if (is_worse(name(from(e)), name(to(e)), name(apex(e)), name(apex(other))) &&
                    flip(e))
                    changed = true;
            });
            if (!changed) break;
        }
    }

    const SpacePoints& global_;
    Progress* progress_;
    SpacePoints places_;
    std::vector<SpacePointId> names_;  ///< of places: the point that is taken to lie there
    std::map<SpacePointId, SpacePointId> by_name_;  ///< and back
    meshing::FlatMesh mesh_;                        ///< of places
    std::vector<HalfEdge> around_;                  ///< of places: an edge that leaves it
    std::size_t axis_ = 0;
    int facing_ = 0;
};

}  // namespace

std::size_t edge_axis(const SpacePoints& points, SpacePointId a, SpacePointId b) {
    const auto &p = points.rounded(a), &q = points.rounded(b);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::abs(p[k] - q[k]) > std::abs(p[axis] - q[axis])) axis = k;
    }
    return axis;
}

std::vector<TriangleCorners> divided(const SpacePoints& points, const FacetPoints& facet,
                                     Progress* progress) {
    std::vector<SpacePointId> loop;
    std::optional<std::size_t> folded;  // the edge that the corner across it lies on
    for (std::size_t k = 0; k < 3; ++k) {
        loop.push_back(facet.corners[k]);
        const auto& between = facet.on_edges[k];
        if (std::find(between.begin(), between.end(), facet.corners[(k + 2) % 3]) != between.end())
            folded = k;
        loop.insert(loop.end(), between.begin(), between.end());
    }
    std::vector<TriangleCorners> triangles;
    if (folded) {
        // two polygons that meet in that corner, with hardly any area
        const SpacePointId tip = facet.corners[(*folded + 2) % 3];
        std::rotate(loop.begin(), std::find(loop.begin(), loop.end(), tip), loop.end());
        const auto again = std::find(loop.begin() + 1, loop.end(), tip);
        add_fan({loop.begin(), again}, triangles);
        add_fan({again, loop.end()}, triangles);
        return triangles;
    }
    const FacetDivision division(points, facet, progress);
    if (division.has_area()) return division.result();
    add_fan(loop, triangles);
    return triangles;
}

}  // namespace realmodel::booleans
