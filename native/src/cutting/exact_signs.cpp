// SPDX-License-Identifier: GPL-3.0-or-later
// On which side of each other points lie: the cheap ways to tell come first.
#include <algorithm>
#include <cmath>

#include "cutting/exact_points.hpp"
#include "cutting/fractions.hpp"
#include "cutting/wide_places.hpp"

namespace realmodel::cutting {

using exact::DoubleDoubleInterval;

namespace {

/// The way from one coordinate to another: without error where both are doubles.
DoubleDoubleInterval between(const DoubleDoubleInterval& from, const DoubleDoubleInterval& to) {
    const auto is_double = [](const DoubleDoubleInterval& x) { return x.low == 0 && x.error == 0; };
    if (is_double(from) && is_double(to))
        return DoubleDoubleInterval::difference(to.high, from.high);
    return to - from;
}

}  // namespace

/// A bound of how far the rounded differences of these points may be from the true ones.
double ExactPoints::slack(NodeId a, NodeId b, NodeId c, NodeId d) const {
    double largest = 0;
    for (const NodeId p : {a, b, c, d}) {
        if (is_double(p)) continue;
        for (const double x : rounded(p))
            largest = std::max(largest, std::abs(x));
    }
    return 0x1p-51 * largest;
}

int ExactPoints::orientation(NodeId a, NodeId b, NodeId c, NodeId d) const {
    if (a == b || a == c || a == d || b == c || b == d || c == d) return 0;
    const Position &o = rounded(a), &p = rounded(b), &q = rounded(c), &r = rounded(d);
    Position u, v, w;
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        u[k] = p[k] - o[k];
        v[k] = q[k] - o[k];
        w[k] = r[k] - o[k];
        largest = std::max({largest, std::abs(u[k]), std::abs(v[k]), std::abs(w[k])});
    }
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
                 z = u[0] * v[1] - u[1] * v[0];
    const double value = x * w[0] + y * w[1] + z * w[2];
    const double size = (std::abs(u[1] * v[2]) + std::abs(u[2] * v[1])) * std::abs(w[0]) +
                        (std::abs(u[2] * v[0]) + std::abs(u[0] * v[2])) * std::abs(w[1]) +
                        (std::abs(u[0] * v[1]) + std::abs(u[1] * v[0])) * std::abs(w[2]);
    // six products of three differences, each of which may be off by `off`
    const double off = slack(a, b, c, d);
    const double error = 0x1p-48 * size + 24 * off * (largest + off) * (largest + off) + 1e-280;
    if (value > error) return 1;
    if (value < -error) return -1;
    const std::array points{a, b, c, d};
    if (lie_on_one_plane_by_name(points)) return 0;
    if (const auto told = orientation_of_balls(points)) return *told;
    if (const auto told = Wide(*this, points).orientation(points)) return *told;
    const Fractions e = exact(a);
    const auto from_a = [&](NodeId node) { return minus(exact(node), e); };
    return sgn(determinant(from_a(b), from_a(c), from_a(d)));
}

int ExactPoints::turn(std::size_t axis, NodeId a, NodeId b, NodeId c) const {
    if (a == b || a == c || b == c) return 0;
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    const Position &o = rounded(a), &p = rounded(b), &q = rounded(c);
    const double left = (p[k] - o[k]) * (q[l] - o[l]), right = (p[l] - o[l]) * (q[k] - o[k]);
    const double largest = std::max({std::abs(p[k] - o[k]), std::abs(q[l] - o[l]),
                                     std::abs(p[l] - o[l]), std::abs(q[k] - o[k])});
    const double off = slack(a, b, c, a);
    const double error =
        0x1p-49 * (std::abs(left) + std::abs(right)) + 8 * off * (largest + off) + 1e-280;
    if (left - right > error) return 1;
    if (left - right < -error) return -1;
    const std::array points{a, b, c};
    if (lie_on_one_line_by_name(points)) return 0;
    if (const auto told = turn_of_balls(axis, points)) return *told;
    if (const auto told = Wide(*this, points).turn(axis, points)) return *told;
    const Fractions e = exact(a), f = exact(b), g = exact(c);
    const mpq_class one = (f[k] - e[k]) * (g[l] - e[l]), other = (f[l] - e[l]) * (g[k] - e[k]);
    const int order = cmp(one, other);
    return (order > 0) - (order < 0);
}

int ExactPoints::compare(std::size_t axis, NodeId a, NodeId b) const {
    if (a == b) return 0;
    const double x = rounded(a)[axis], y = rounded(b)[axis];
    if (x != y) return x < y ? -1 : 1;  // rounding keeps the order
    if (is_double(a) && is_double(b)) return 0;
    const auto p = ball(a, axis), q = ball(b, axis);
    if (p && q) {
        if (const auto sign = between(*q, *p).sign()) return *sign;
    }
    if (const auto told = Wide(*this, std::array{a, b}).compare(axis, a, b)) return *told;
    const int order = cmp(exact(a)[axis], exact(b)[axis]);
    return (order > 0) - (order < 0);
}

int ExactPoints::compare(NodeId a, NodeId b) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int order = compare(axis, a, b);
        if (order != 0) return order;
    }
    return 0;
}

/// Whether points were made in one plane, or are its corners.
bool ExactPoints::lie_on_one_plane_by_name(const std::array<NodeId, 4>& points) const {
    for (const NodeId candidate : points) {
        const Made* own = made(candidate);
        if (own == nullptr) continue;
        const auto corners = std::span(own->crossing.of).subspan<2>();
        const auto is_corner = [&](NodeId p) {
            return std::find(corners.begin(), corners.end(), p) != corners.end();
        };
        const bool all = std::all_of(points.begin(), points.end(), [&](NodeId p) {
            const Made* other = made(p);
            if (other == nullptr) return is_corner(p);
            const Crossing& crossing = other->crossing;
            return crossing.is_on_plane_of(own->crossing) ||
                   (is_corner(crossing.of[0]) && is_corner(crossing.of[1]));
        });
        if (all) return true;
    }
    for (std::size_t without = 0; without < 4; ++without) {
        if (lie_on_one_line_by_name(
                {points[(without + 1) % 4], points[(without + 2) % 4], points[(without + 3) % 4]}))
            return true;
    }
    return false;
}

/// Whether points were made on one line, or are its ends.
bool ExactPoints::lie_on_one_line_by_name(const std::array<NodeId, 3>& points) const {
    for (const NodeId candidate : points) {
        const Made* own = made(candidate);
        if (own == nullptr) continue;
        const NodeId from = own->crossing.of[0], to = own->crossing.of[1];
        const bool all = std::all_of(points.begin(), points.end(), [&](NodeId p) {
            const Made* other = made(p);
            return other == nullptr ? p == from || p == to : other->crossing.is_on_line(from, to);
        });
        if (all) return true;
    }
    return false;
}

std::optional<DoubleDoubleInterval> ExactPoints::ball(NodeId p, std::size_t axis) const {
    if (const Made* made = this->made(p)) return made->at[axis];
    if (is_double(p)) return DoubleDoubleInterval(rounded(p)[axis]);
    return std::nullopt;
}

std::optional<int> ExactPoints::orientation_of_balls(const std::array<NodeId, 4>& points) const {
    std::array<std::array<DoubleDoubleInterval, 3>, 3> way;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto from = ball(points[0], k);
        if (!from) return std::nullopt;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto to = ball(points[i + 1], k);
            if (!to) return std::nullopt;
            way[i][k] = between(*from, *to);
        }
    }
    const auto& [u, v, w] = way;
    return (w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
            w[2] * (u[0] * v[1] - u[1] * v[0]))
        .sign();
}

std::optional<int> ExactPoints::turn_of_balls(std::size_t axis,
                                              const std::array<NodeId, 3>& points) const {
    std::array<std::array<DoubleDoubleInterval, 2>, 2> way;
    for (std::size_t k = 0; k < 2; ++k) {
        const auto from = ball(points[0], (axis + 1 + k) % 3);
        if (!from) return std::nullopt;
        for (std::size_t i = 0; i < 2; ++i) {
            const auto to = ball(points[i + 1], (axis + 1 + k) % 3);
            if (!to) return std::nullopt;
            way[i][k] = between(*from, *to);
        }
    }
    return (way[0][0] * way[1][1] - way[0][1] * way[1][0]).sign();
}

/// The point that is best taken as the origin of the others: one whose weight is 1, if any.
std::size_t ExactPoints::Wide::simplest(std::span<const Place> places) {
    const auto found = std::find_if(places.begin(), places.end(),
                                    [](const Place& place) { return place.is_whole; });
    return found == places.end() ? 0 : static_cast<std::size_t>(found - places.begin());
}

std::optional<int> ExactPoints::Wide::orientation(const std::array<NodeId, 4>& points) const {
    std::array<Place, 4> places{place(points[0]), place(points[1]), place(points[2]),
                                place(points[3])};
    // each exchange of two points turns the sign
    const std::size_t origin = simplest(places);
    int sign = 1;
    if (origin != 0) {
        std::swap(places[0], places[origin]);
        sign = -1;
    }
    std::array<std::array<Integer, 3>, 3> way;
    for (std::size_t i = 0; i < 3; ++i) {
        way[i] = from_other(places[i + 1], places[0]);
        sign *= sign_of_weight(places[i + 1]) * sign_of_weight(places[0]);
    }
    const auto& [u, v, w] = way;
    const Integer found = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                          w[2] * (u[0] * v[1] - u[1] * v[0]);
    if (!is_known(found)) return std::nullopt;
    return sign * sign_of(found);
}

std::optional<int> ExactPoints::Wide::turn(std::size_t axis,
                                           const std::array<NodeId, 3>& points) const {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    std::array<Place, 3> places{place(points[0]), place(points[1]), place(points[2])};
    const std::size_t origin = simplest(places);
    std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(origin), places.end());
    const auto u = from_other(places[1], places[0]), v = from_other(places[2], places[0]);
    const Integer found = u[k] * v[l] - u[l] * v[k];
    if (!is_known(found)) return std::nullopt;
    return sign_of(found) * sign_of_weight(places[1]) * sign_of_weight(places[2]);
}

std::optional<int> ExactPoints::Wide::compare(std::size_t axis, NodeId a, NodeId b) const {
    const Place p = place(a), q = place(b);
    const Integer found = times(p.at[axis], q) - times(q.at[axis], p);
    if (!is_known(found)) return std::nullopt;
    return sign_of(found) * sign_of_weight(p) * sign_of_weight(q);
}

int ExactPoints::ray_passes(std::size_t axis, NodeId p, const std::array<NodeId, 3>& corners,
                            bool from_below) const {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    for (const std::size_t across : {k, l}) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const NodeId c : corners) {
            low = std::min(low, rounded(c)[across]);
            high = std::max(high, rounded(c)[across]);
        }
        if (rounded(p)[across] < low || rounded(p)[across] > high) return 0;
    }
    const int turned = turn(axis, corners[0], corners[1], corners[2]);
    if (turned == 0) return 0;
    // edges to the right of p, which is taken to be a little to the right and less upward from here
    bool inside = false;
    for (std::size_t i = 0; i < 3; ++i) {
        NodeId a = corners[i], b = corners[(i + 1) % 3];
        const bool above_a = compare(l, a, p) > 0, above_b = compare(l, b, p) > 0;
        if (above_a == above_b) continue;
        if (above_a) std::swap(a, b);
        if (turn(axis, a, b, p) > 0) inside = !inside;
    }
    if (!inside) return 0;
    const int side = turned * orientation(corners[0], corners[1], corners[2], p);
    return side < 0 || (side == 0 && from_below) ? turned : 0;
}

bool ExactPoints::is_farther(std::size_t axis, NodeId a, NodeId b, NodeId p, NodeId q) const {
    const Fractions o = exact(a), way = minus(exact(b), o);
    return abs(cross(way, minus(exact(p), o), axis)) > abs(cross(way, minus(exact(q), o), axis));
}

}  // namespace realmodel::cutting
