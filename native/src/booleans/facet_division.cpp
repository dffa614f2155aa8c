// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facet_division.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "arrangement/polygons.hpp"
#include "exact/space_predicates.hpp"

namespace realmodel::booleans {

namespace {

/// Triangles of a polygon of any shape: a fan from its least corner. Those without extent are left
/// out.
void add_fan(const std::vector<SpacePointId>& loop, std::vector<Corners>& triangles) {
    const auto least =
        static_cast<std::size_t>(std::min_element(loop.begin(), loop.end()) - loop.begin());
    const auto at = [&](std::size_t i) { return loop[(least + i) % loop.size()]; };
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        const Corners t{at(0), at(i), at(i + 1)};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
}

/// A triangulation of one triangle, in which points are where they would be if they lay on it. Its
/// point numbers are its own.
class FacetDivision {
public:
    FacetDivision(const SpacePoints& points, const FacetPoints& facet) : global_(points) {
        Corners own;
        for (std::size_t k = 0; k < 3; ++k)
            own[k] = enter(places_.add(points.rounded(facet.corners[k])), facet.corners[k]);
        for (axis_ = 0; axis_ < 3 && facing_ == 0; ++axis_)
            facing_ = exact::orient2d(places_, axis_, own[0], own[1], own[2]);
        if (facing_ == 0) return;
        --axis_;
        find_best_axis(facet.corners);
        triangles_.push_back(own);
        for (std::size_t k = 0; k < 3; ++k)
            divide_edge(own[k], own[(k + 1) % 3], facet.on_edges[k]);
        for (const SpacePointId p : facet.within)
            insert(p, own);
        for (const Edge& edge : facet.wanted)
            insert_edge(edge);
        improve();
    }

    bool has_area() const { return facing_ != 0; }
    std::vector<Corners> result() const {
        std::vector<Corners> found;
        for (const Corners& t : triangles_)
            found.push_back({name(t[0]), name(t[1]), name(t[2])});
        return found;
    }

private:
    /// The view along the axis in which the triangle is largest, among those in which it has an
    /// area.
    void find_best_axis(const Corners& corners) {
        double largest = -1;
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = global_.rounded(corners[k]);
        const Corners own{SpacePointId(0), SpacePointId(1), SpacePointId(2)};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            const double area = std::abs((p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) -
                                         (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]));
            if (area <= largest) continue;
            const int turn = exact::orient2d(places_, axis, own[0], own[1], own[2]);
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
        return place;
    }
    SpacePointId name(SpacePointId place) const { return names_[index(place)]; }
    SpacePointId place_of(SpacePointId p) const {
        const auto found = std::find(names_.begin(), names_.end(), p);
        return found == names_.end() ? SpacePointId(kNone) : SpacePointId(found - names_.begin());
    }
    int turn(SpacePointId a, SpacePointId b, SpacePointId c) const {
        return facing_ * exact::orient2d(places_, axis_, a, b, c);
    }
    /// The triangle that has an edge in this direction, and its third corner.
    struct Side {
        std::size_t triangle;
        SpacePointId tip;
    };
    std::optional<Side> left_of(SpacePointId a, SpacePointId b) const {
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (triangles_[t][k] == a && triangles_[t][(k + 1) % 3] == b)
                    return Side{t, triangles_[t][(k + 2) % 3]};
            }
        }
        return std::nullopt;
    }

    void divide_edge(SpacePointId from, SpacePointId to, const std::vector<SpacePointId>& between) {
        const std::size_t axis = edge_axis(global_, name(from), name(to));
        const SpacePointId end_of[2] = {from, to};
        for (const SpacePointId p : between) {
            const SpacePointId place = enter(
                places_.projected(axis, places_.add(global_.rounded(p)), end_of[0], end_of[1]), p);
            if (!place.has_value()) continue;
            const auto side = left_of(from, to);
            triangles_[side->triangle] = {from, place, side->tip};
            triangles_.push_back({place, to, side->tip});
            from = place;
        }
    }

    void insert(SpacePointId p, const Corners& corners) {
        if (place_of(p).has_value()) return;
        const SpacePointId raw = places_.add(global_.rounded(p));
        const SpacePointId place =
            places_.projected(axis_, raw, corners[0], corners[1], corners[2]);
        if (index(place) < names_.size() && name(place).has_value()) return;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const Corners at = triangles_[t];
            std::array<int, 3> turns;
            for (std::size_t k = 0; k < 3; ++k)
                turns[k] = turn(at[k], at[(k + 1) % 3], place);
            if (*std::min_element(turns.begin(), turns.end()) < 0) continue;
            const auto zero = std::find(turns.begin(), turns.end(), 0);
            if (zero == turns.end()) {
                enter(place, p);
                triangles_[t] = {at[0], at[1], place};
                triangles_.push_back({at[1], at[2], place});
                triangles_.push_back({at[2], at[0], place});
                return;
            }
            const auto k = static_cast<std::size_t>(zero - turns.begin());
            const SpacePointId a = at[k], b = at[(k + 1) % 3], c = at[(k + 2) % 3];
            const auto other = left_of(b, a);
            if (!other) return;  // on the outline
            enter(place, p);
            triangles_[t] = {a, place, c};
            triangles_.push_back({place, b, c});
            triangles_[other->triangle] = {b, place, other->tip};
            triangles_.push_back({place, a, other->tip});
            return;
        }
    }

    bool is_kept(SpacePointId a, SpacePointId b) const {
        return std::find(kept_.begin(), kept_.end(), Edge{std::min(a, b), std::max(a, b)}) !=
               kept_.end();
    }
    /// Exchanges the diagonal from a to b with the other one of its quadrilateral, if that is
    /// convex.
    bool flip(SpacePointId a, SpacePointId b) {
        const auto left = left_of(a, b), right = left_of(b, a);
        if (!left || !right) return false;
        const SpacePointId c = left->tip, d = right->tip;
        if (turn(d, b, c) <= 0 || turn(c, a, d) <= 0) return false;
        triangles_[left->triangle] = {a, d, c};
        triangles_[right->triangle] = {d, b, c};
        return true;
    }
    /// Flips what crosses an edge until nothing does (S. W. Sloan, "A fast algorithm for generating
    /// constrained Delaunay triangulations", 1993). Nothing where it runs over a point or crosses
    /// an edge that is kept.
    void insert_edge(const Edge& edge) {
        const SpacePointId p = place_of(edge[0]), q = place_of(edge[1]);
        if (!p.has_value() || !q.has_value() || p == q) return;
        const auto is_crossed_by = [&](SpacePointId a, SpacePointId b) {
            if (a == p || a == q || b == p || b == q) return false;
            return turn(p, q, a) * turn(p, q, b) < 0 && turn(a, b, p) * turn(a, b, q) < 0;
        };
        for (const Corners& t : triangles_) {
            for (const SpacePointId v : t) {
                if (v != p && v != q && turn(p, q, v) == 0 &&
                    exact::compare(places_, p, v) * exact::compare(places_, v, q) > 0)
                    return;
            }
        }
        std::vector<Edge> crossed;
        for (const Corners& t : triangles_) {
            for (std::size_t k = 0; k < 3; ++k) {
                const SpacePointId a = t[k], b = t[(k + 1) % 3];
                if (!(a < b) || !is_crossed_by(a, b)) continue;
                if (is_kept(a, b)) return;
                crossed.push_back({a, b});
            }
        }
        for (std::size_t i = 0; i < crossed.size() && i < 10000; ++i) {
            const auto [a, b] = crossed[i];
            const auto left = left_of(a, b), right = left_of(b, a);
            if (!flip(a, b)) {
                crossed.push_back({a, b});
            } else if (is_crossed_by(left->tip, right->tip)) {
                crossed.push_back(
                    {std::min(left->tip, right->tip), std::max(left->tip, right->tip)});
            }
        }
        kept_.push_back({std::min(p, q), std::max(p, q)});
    }
    /// The cotangent of the angle at a point, between two others.
    double cotangent(SpacePointId at, SpacePointId from, SpacePointId to) const {
        const auto &p = global_.rounded(at), &q = global_.rounded(from), &r = global_.rounded(to);
        const auto u = arrangement::minus(q, p), v = arrangement::minus(r, p);
        const std::array<double, 3> normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                           u[0] * v[1] - u[1] * v[0]};
        return arrangement::dot(u, v) / std::sqrt(arrangement::dot(normal, normal));
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
            for (std::size_t t = 0; t < triangles_.size(); ++t) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const SpacePointId a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
                    if (is_kept(a, b)) continue;
                    const auto other = left_of(b, a);
                    if (other &&
                        is_worse(name(a), name(b), name(triangles_[t][(k + 2) % 3]),
                                 name(other->tip)) &&
                        flip(a, b))
                        changed = true;
                }
            }
            if (!changed) break;
        }
    }

    const SpacePoints& global_;
    SpacePoints places_;
    std::vector<SpacePointId> names_;  ///< of places: the point that is taken to lie there
    std::vector<Corners> triangles_;
    std::vector<Edge> kept_;
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

std::vector<Corners> divided(const SpacePoints& points, const FacetPoints& facet) {
    std::vector<SpacePointId> loop;
    std::optional<std::size_t> folded;  // the edge that the corner across it lies on
    for (std::size_t k = 0; k < 3; ++k) {
        loop.push_back(facet.corners[k]);
        const auto& between = facet.on_edges[k];
        if (std::find(between.begin(), between.end(), facet.corners[(k + 2) % 3]) != between.end())
            folded = k;
        loop.insert(loop.end(), between.begin(), between.end());
    }
    std::vector<Corners> triangles;
    if (folded) {
        // two polygons that meet in that corner, with hardly any area
        const SpacePointId tip = facet.corners[(*folded + 2) % 3];
        std::rotate(loop.begin(), std::find(loop.begin(), loop.end(), tip), loop.end());
        const auto again = std::find(loop.begin() + 1, loop.end(), tip);
        add_fan({loop.begin(), again}, triangles);
        add_fan({again, loop.end()}, triangles);
        return triangles;
    }
    const FacetDivision division(points, facet);
    if (division.has_area()) return division.result();
    add_fan(loop, triangles);
    return triangles;
}

}  // namespace realmodel::booleans
