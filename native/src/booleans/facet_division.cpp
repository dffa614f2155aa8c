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
    FacetDivision(const SpacePoints& points, const FacetPoints& facet, Progress* progress)
        : global_(points), progress_(progress) {
        Corners own;
        for (std::size_t k = 0; k < 3; ++k)
            own[k] = enter(places_.add(points.rounded(facet.corners[k])), facet.corners[k]);
        for (axis_ = 0; axis_ < 3 && facing_ == 0; ++axis_)
            facing_ = exact::orient2d(places_, axis_, own[0], own[1], own[2]);
        if (facing_ == 0) return;
        --axis_;
        find_best_axis(facet.corners);
        triangles_.push_back({own});
        note_corners(0);
        for (std::size_t k = 0; k < 3; ++k)
            divide_edge(own[k], own[(k + 1) % 3], facet.on_edges[k]);
        for (const SpacePointId p : facet.within)
            insert(p, own);
        for (const Edge& edge : facet.wanted)
            insert_edge(edge);
        improve();
        assert(is_triangulation(facet));
    }

    bool has_area() const { return facing_ != 0; }
    std::vector<Corners> result() const {
        std::vector<Corners> found;
        for (const Triangle& t : triangles_)
            found.push_back({name(t.corners[0]), name(t.corners[1]), name(t.corners[2])});
        return found;
    }

private:
    using TriangleId = std::int32_t;
    struct Triangle {
        Corners corners;
        std::array<TriangleId, 3> across{-1, -1, -1};  ///< of the edge from each corner; -1: none
        std::array<bool, 3> is_kept{};                 ///< whether that edge stays
    };
    /// An edge of a triangle: that from corner k on.
    struct Side {
        TriangleId triangle = -1;
        std::size_t k = 0;
    };

    /// Whether neighbors know each other, and triangles are as many as points on edges and two for
    /// each within, and one.
    bool is_triangulation(const FacetPoints& facet) const {
        std::size_t outer = 0, points = 0;
        for (TriangleId t = 0; index(t) < triangles_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Side own{t, k}, other = across(own);
                if (other.triangle < 0) {
                    ++outer;
                } else if (across(other).triangle != t || corner(own, 0) != corner(other, 1) ||
                           corner(own, 1) != corner(other, 0)) {
                    return false;
                }
            }
        }
        for (const SpacePointId p : names_)
            points += p.has_value() ? 1 : 0;
        return outer <= 3 + facet.on_edges[0].size() + facet.on_edges[1].size() +
                            facet.on_edges[2].size() &&
               triangles_.size() == 2 * points - outer - 2;
    }

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
        by_name_.emplace(p, place);
        return place;
    }
    SpacePointId name(SpacePointId place) const { return names_[index(place)]; }
    SpacePointId place_of(SpacePointId p) const {
        const auto found = by_name_.find(p);
        return found == by_name_.end() ? SpacePointId(kNone) : found->second;
    }
    int turn(SpacePointId a, SpacePointId b, SpacePointId c) const {
        return facing_ * exact::orient2d(places_, axis_, a, b, c);
    }

    Triangle& at(TriangleId t) { return triangles_[index(t)]; }
    const Triangle& at(TriangleId t) const { return triangles_[index(t)]; }
    SpacePointId corner(const Side& side, std::size_t turned) const {
        return at(side.triangle).corners[(side.k + turned) % 3];
    }
    /// The same edge as the triangle across it has it; of no triangle on the outline.
    Side across(const Side& side) const {
        const TriangleId other = at(side.triangle).across[side.k];
        if (other < 0) return {};
        const SpacePointId from = corner(side, 1);
        for (std::size_t k = 0; k < 2; ++k) {
            if (at(other).corners[k] == from) return {other, k};
        }
        return {other, 2};
    }
    void note_corners(TriangleId t) {
        for (const SpacePointId p : at(t).corners) {
            around_.resize(std::max(around_.size(), index(p) + 1), -1);
            around_[index(p)] = t;
        }
    }
    /// The edge from a to b as the triangle to its left has it; of no triangle where there is none.
    Side left_of(SpacePointId a, SpacePointId b) const {
        Side found;
        each_around(a, [&](const Side& side) {
            if (corner(side, 1) == b) found = side;
            return found.triangle < 0;
        });
        return found;
    }
    /// Calls visit(side) for the edges that leave a corner, with the triangles to their left, until
    /// it is false: counter-clockwise, and from the first one clockwise where the outline is met.
    template <class Visit>
    void each_around(SpacePointId p, const Visit& visit) const {
        const TriangleId first = around_[index(p)];
        const auto from_corner = [&](TriangleId t) {
            std::size_t k = 0;
            while (at(t).corners[k] != p)
                ++k;
            return Side{t, k};
        };
        const auto go = [&](TriangleId t, std::size_t edge) {
            const Side own = from_corner(t);
            return at(t).across[(own.k + edge) % 3];
        };
        TriangleId t = first;
        do {
            if (!visit(from_corner(t))) return;
            t = go(t, 2);
        } while (t >= 0 && t != first);
        if (t == first) return;
        for (t = go(first, 0); t >= 0; t = go(t, 0)) {
            if (!visit(from_corner(t))) return;
        }
    }
    /// Makes two triangles neighbors across an edge of the first; the other one may be none.
    void link(const Side& side, const Side& other) {
        at(side.triangle).across[side.k] = other.triangle;
        if (other.triangle < 0) return;
        at(other.triangle).across[other.k] = side.triangle;
        at(side.triangle).is_kept[side.k] = at(other.triangle).is_kept[other.k];
    }
    TriangleId add(const Corners& corners) {
        triangles_.push_back({corners});
        return static_cast<TriangleId>(triangles_.size()) - 1;
    }
    /// Divides a triangle at a point of its edge: in {from, p, tip}, which keeps its number, and
    /// {p, to, tip}.
    TriangleId split(const Side& side, SpacePointId p) {
        const SpacePointId from = corner(side, 0), to = corner(side, 1), tip = corner(side, 2);
        const Side next{side.triangle, (side.k + 1) % 3}, last{side.triangle, (side.k + 2) % 3};
        const Side beyond_next = across(next), beyond_last = across(last);
        const TriangleId own = side.triangle, second = add({p, to, tip});
        at(own) = {{from, p, tip}};
        link({second, 1}, beyond_next);
        link({own, 2}, beyond_last);
        link({own, 1}, {second, 2});
        note_corners(own);
        note_corners(second);
        return second;
    }

    void divide_edge(SpacePointId from, SpacePointId to, const std::vector<SpacePointId>& between) {
        const std::size_t axis = edge_axis(global_, name(from), name(to));
        const SpacePointId end_of[2] = {from, to};
        Side side = left_of(from, to);
        for (const SpacePointId p : between) {
            if (progress_ != nullptr) progress_->check();
            const SpacePointId place = enter(
                places_.projected(axis, places_.add(global_.rounded(p)), end_of[0], end_of[1]), p);
            if (!place.has_value()) continue;
            assert(side.triangle >= 0 && corner(side, 1) == to);
            side = {split(side, place), 0};
        }
    }

    /// The triangle that has a place, and the turns of its edges and that: a walk towards it
    /// (remembering where it came from), and all triangles in their order where that goes round.
    Side triangle_with(SpacePointId place, std::array<int, 3>& turns) const {
        const auto has_place = [&](TriangleId t) {
            for (std::size_t k = 0; k < 3; ++k)
                turns[k] = turn(at(t).corners[k], at(t).corners[(k + 1) % 3], place);
            return *std::min_element(turns.begin(), turns.end()) >= 0;
        };
        TriangleId t = static_cast<TriangleId>(triangles_.size()) - 1;
        for (std::size_t step = 0; step < triangles_.size() && t >= 0; ++step) {
            if (has_place(t)) return {t, 0};
            const auto least =
                std::find_if(turns.begin(), turns.end(), [](int n) { return n < 0; });
            t = at(t).across[static_cast<std::size_t>(least - turns.begin())];
        }
        for (t = 0; index(t) < triangles_.size(); ++t) {
            if (has_place(t)) return {t, 0};
        }
        return {};
    }

    void insert(SpacePointId p, const Corners& corners) {
        if (progress_ != nullptr) progress_->check();
        if (place_of(p).has_value()) return;
        const SpacePointId raw = places_.add(global_.rounded(p));
        const SpacePointId place =
            places_.projected(axis_, raw, corners[0], corners[1], corners[2]);
        if (index(place) < names_.size() && name(place).has_value()) return;
        std::array<int, 3> turns{};
        Side side = triangle_with(place, turns);
        if (side.triangle < 0) return;  // outside
        const auto zero = std::find(turns.begin(), turns.end(), 0);
        if (zero != turns.end()) {
            side.k = static_cast<std::size_t>(zero - turns.begin());
            const Side other = across(side);
            if (other.triangle < 0) return;  // on the outline
            enter(place, p);
            const TriangleId second = split(side, place);
            const TriangleId other_second = split(other, place);
            // split() left {from, p, tip} and {p, to, tip}, the other way round beyond the edge
            link({side.triangle, 0}, {other_second, 0});
            link({second, 0}, {other.triangle, 0});
            return;
        }
        enter(place, p);
        const Triangle old = at(side.triangle);
        std::array<Side, 3> beyond;
        for (std::size_t k = 0; k < 3; ++k)
            beyond[k] = across({side.triangle, k});
        const auto& c = old.corners;
        const std::array<TriangleId, 3> made{side.triangle, add({c[1], c[2], place}),
                                             add({c[2], c[0], place})};
        at(made[0]) = {{c[0], c[1], place}};
        for (std::size_t k = 0; k < 3; ++k) {
            link({made[k], 0}, beyond[k]);
            link({made[k], 1}, {made[(k + 1) % 3], 2});
        }
        for (const TriangleId t : made)
            note_corners(t);
    }

    /// Exchanges a diagonal with the other one of its quadrilateral, if that is convex.
    bool flip(const Side& left) {
        const Side right = across(left);
        if (right.triangle < 0) return false;
        const SpacePointId a = corner(left, 0), b = corner(left, 1), c = corner(left, 2),
                           d = corner(right, 2);
        if (turn(d, b, c) <= 0 || turn(c, a, d) <= 0) return false;
        const TriangleId one = left.triangle, other = right.triangle;
        const Side beyond_bc{one, (left.k + 1) % 3}, beyond_ca{one, (left.k + 2) % 3},
            beyond_ad{other, (right.k + 1) % 3}, beyond_db{other, (right.k + 2) % 3};
        const Side bc = across(beyond_bc), ca = across(beyond_ca), ad = across(beyond_ad),
                   db = across(beyond_db);
        at(one) = {{a, d, c}};
        at(other) = {{d, b, c}};
        link({one, 0}, ad);
        link({one, 2}, ca);
        link({other, 0}, db);
        link({other, 1}, bc);
        link({one, 1}, {other, 2});
        note_corners(one);
        note_corners(other);
        return true;
    }
    void keep(const Side& side) {
        at(side.triangle).is_kept[side.k] = true;
        const Side other = across(side);
        if (other.triangle >= 0) at(other.triangle).is_kept[other.k] = true;
    }

    /// The edges that the line between two corners crosses, from one to the other; nothing where it
    /// runs over a point or crosses an edge that is kept.
    std::optional<std::vector<Edge>> crossed_edges(SpacePointId p, SpacePointId q) const {
        Side crossed;
        bool is_free = true;
        each_around(p, [&](const Side& side) {
            const SpacePointId b = corner(side, 1), c = corner(side, 2);
            const int to_b = turn(p, q, b), to_c = turn(p, q, c);
            for (const auto& [v, side_of_v] : {std::pair(b, to_b), std::pair(c, to_c)})
                is_free = is_free && (side_of_v != 0 || !is_between(v, p, q));
            if (to_b < 0 && to_c > 0) crossed = {side.triangle, (side.k + 1) % 3};
            return is_free && crossed.triangle < 0;
        });
        if (!is_free || crossed.triangle < 0) return std::nullopt;
        std::vector<Edge> found;
        for (;;) {
            if (at(crossed.triangle).is_kept[crossed.k]) return std::nullopt;
            found.push_back({corner(crossed, 0), corner(crossed, 1)});
            const Side next = across(crossed);
            if (next.triangle < 0) return std::nullopt;
            const SpacePointId tip = corner(next, 2);
            if (tip == q) return found;
            const int side = turn(p, q, tip);
            if (side == 0) return std::nullopt;
            // of the two edges at the tip the one whose other end is on the other side
            crossed = {next.triangle, (next.k + (side > 0 ? 1 : 2)) % 3};
        }
    }
    bool is_between(SpacePointId v, SpacePointId p, SpacePointId q) const {
        return v != q && exact::compare(places_, p, v) * exact::compare(places_, v, q) > 0;
    }

    /// Flips what crosses an edge until nothing does (S. W. Sloan, "A fast algorithm for generating
    /// constrained Delaunay triangulations", 1993). Nothing where it runs over a point or crosses
    /// an edge that is kept.
    void insert_edge(const Edge& edge) {
        if (progress_ != nullptr) progress_->check();
        const SpacePointId p = place_of(edge[0]), q = place_of(edge[1]);
        if (!p.has_value() || !q.has_value() || p == q) return;
        for (const auto& [from, to] : {std::pair(p, q), std::pair(q, p)}) {
            const Side own = left_of(from, to);
            if (own.triangle >= 0) return keep(own);
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
            const Side left = left_of(a, b);
            const SpacePointId c = corner(left, 2), d = corner(across(left), 2);
            if (!flip(left)) {
                crossed->push_back({a, b});
            } else if (is_crossed_by(c, d)) {
                crossed->push_back({c, d});
            }
        }
        const Side made = left_of(p, q);
        if (made.triangle >= 0) keep(made);
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
            for (TriangleId t = 0; index(t) < triangles_.size(); ++t) {
                poll(progress_, index(t));
                for (std::size_t k = 0; k < 3; ++k) {
                    const Side own{t, k}, other = across(own);
                    if (other.triangle < 0 || at(t).is_kept[k]) continue;
                    if (is_worse(name(corner(own, 0)), name(corner(own, 1)), name(corner(own, 2)),
                                 name(corner(other, 2))) &&
                        flip(own))
                        changed = true;
                }
            }
            if (!changed) break;
        }
    }

    const SpacePoints& global_;
    Progress* progress_;
    SpacePoints places_;
    std::vector<SpacePointId> names_;  ///< of places: the point that is taken to lie there
    std::map<SpacePointId, SpacePointId> by_name_;  ///< and back
    std::vector<Triangle> triangles_;
    std::vector<TriangleId> around_;  ///< of places: a triangle that has it as a corner
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

std::vector<Corners> divided(const SpacePoints& points, const FacetPoints& facet,
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
    const FacetDivision division(points, facet, progress);
    if (division.has_area()) return division.result();
    add_fan(loop, triangles);
    return triangles;
}

}  // namespace realmodel::booleans
