// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "exact/arithmetic.hpp"
#include "realmodel/exact/ball.hpp"

namespace realmodel::cutting {

namespace {

using Fractions = ExactPoints::Fractions;

Fractions minus(const Fractions& a, const Fractions& b) {
    return {mpq_class(a[0] - b[0]), mpq_class(a[1] - b[1]), mpq_class(a[2] - b[2])};
}

mpq_class determinant(const Fractions& u, const Fractions& v, const Fractions& w) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

mpq_class cross(const Fractions& u, const Fractions& v, std::size_t axis) {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    return u[k] * v[l] - u[l] * v[k];
}

}  // namespace

std::size_t ExactPoints::Hash::operator()(const Position& p) const {
    std::uint64_t hash = 0;
    for (const double x : p) {
        hash ^= std::bit_cast<std::uint64_t>(x + 0.0);  // both zeros alike
        hash *= 0x9e3779b97f4a7c15ULL;
        hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash);
}

/// Whether a point with these doubles is the one given; `exact` is null where its doubles are
/// exact.
bool ExactPoints::is_same(NodeId p, const Position& rounded, const Fractions* exact) const {
    if (is_double(p)) return exact == nullptr;
    const Fractions own = this->exact(p);
    if (exact != nullptr) return own == *exact;
    return own == Fractions{mpq_class(rounded[0]), mpq_class(rounded[1]), mpq_class(rounded[2])};
}

NodeId ExactPoints::enter(const Position& rounded, std::unique_ptr<Fractions> exact) {
    const auto [begin, end] = known_.equal_range(rounded);
    for (auto found = begin; found != end; ++found) {
        if (is_same(found->second, rounded, exact.get())) return found->second;
    }
    const auto number = static_cast<NodeId>(rounded_.size());
    rounded_.push_back(rounded);
    exact_.push_back(std::move(exact));
    made_of_.push_back(nullptr);
    known_.emplace(rounded, number);
    return number;
}

NodeId ExactPoints::add(const Position& p) {
    return enter({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, nullptr);
}

NodeId ExactPoints::add(Fractions&& p) {
    Position rounded;
    bool doubles = true;
    for (std::size_t k = 0; k < 3; ++k) {
        p[k].canonicalize();
        rounded[k] = exact::nearest_double(p[k].get_num(), p[k].get_den(), 0);
        doubles = doubles && mpq_class(rounded[k]) == p[k];
    }
    return enter(rounded, doubles ? nullptr : std::make_unique<Fractions>(std::move(p)));
}

Fractions ExactPoints::exact(NodeId p) const {
    Fractions own;
    return exact(p, own);
}

const Fractions& ExactPoints::exact(NodeId p, Fractions& own) const {
    auto& known = exact_[index(p)];
    if (known == nullptr && made_of_[index(p)] != nullptr)
        known = std::make_unique<Fractions>(exact_crossing(*made_of_[index(p)]));
    if (known != nullptr) return *known;
    const Position& r = rounded(p);
    for (std::size_t k = 0; k < 3; ++k)
        own[k] = r[k];
    return own;
}

bool ExactPoints::was_made_on(NodeId p, NodeId a, NodeId b) const {
    const auto& made = made_of_[index(p)];
    return made != nullptr && made->of[0] == std::min(a, b) && made->of[1] == std::max(a, b);
}

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
    Fractions of_a, other;
    const Fractions& e = exact(a, of_a);
    const auto from_a = [&](NodeId node) { return minus(exact(node, other), e); };
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
    Fractions of_a, of_b, of_c;
    const Fractions &e = exact(a, of_a), &f = exact(b, of_b), &g = exact(c, of_c);
    const mpq_class one = (f[k] - e[k]) * (g[l] - e[l]), other = (f[l] - e[l]) * (g[k] - e[k]);
    const int order = cmp(one, other);
    return (order > 0) - (order < 0);
}

int ExactPoints::compare(std::size_t axis, NodeId a, NodeId b) const {
    if (a == b) return 0;
    const double x = rounded(a)[axis], y = rounded(b)[axis];
    if (x != y) return x < y ? -1 : 1;  // rounding keeps the order
    if (is_double(a) && is_double(b)) return 0;
    Fractions of_a, of_b;
    return cmp(exact(a, of_a)[axis], exact(b, of_b)[axis]);
}

int ExactPoints::compare(NodeId a, NodeId b) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int order = compare(axis, a, b);
        if (order != 0) return order;
    }
    return 0;
}

std::size_t ExactPoints::CrossingHash::operator()(const Crossing& c) const {
    std::uint64_t hash = 0;
    for (const NodeId node : c.of) {
        hash ^= static_cast<std::uint64_t>(node);
        hash *= 0x9e3779b97f4a7c15ULL;
        hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash);
}

NodeId ExactPoints::crossing(NodeId p, NodeId q, NodeId a, NodeId b, NodeId c) {
    // triangles that share an edge ask for the same place
    std::array<NodeId, 3> plane{a, b, c};
    std::sort(plane.begin(), plane.end());
    const Crossing crossing{{std::min(p, q), std::max(p, q), plane[0], plane[1], plane[2]}};
    const auto [found, is_new] = crossings_.try_emplace(crossing, -1);
    if (!is_new) return found->second;
    const auto rounded = rounded_crossing(crossing);
    if (!rounded || known_.contains(*rounded)) return found->second = add(exact_crossing(crossing));
    found->second = static_cast<NodeId>(rounded_.size());
    rounded_.push_back(*rounded);
    exact_.push_back(nullptr);
    made_of_.push_back(std::make_unique<Crossing>(crossing));
    known_.emplace(*rounded, found->second);
    return found->second;
}

/// The doubles nearest to a crossing of what is given by doubles, where twice their precision
/// tells.
std::optional<Position> ExactPoints::rounded_crossing(const Crossing& crossing) const {
    for (const NodeId node : crossing.of) {
        if (!is_double(node)) return std::nullopt;
    }
    using exact::Ball;
    const auto minus = [this](NodeId p, NodeId q) {
        std::array<Ball, 3> way;
        for (std::size_t k = 0; k < 3; ++k)
            way[k] = Ball::difference(rounded(p)[k], rounded(q)[k]);
        return way;
    };
    const auto [p, q, a, b, c] = crossing.of;
    const auto u = minus(b, a), v = minus(c, a), way = minus(q, p), start = minus(p, a);
    Ball from, change;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        const Ball normal = u[l] * v[m] - u[m] * v[l];
        from = from + normal * start[k];
        change = change + normal * way[k];
    }
    const Ball share = -from / change;
    Position result;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto x = (Ball(rounded(p)[k]) + share * way[k]).rounded();
        if (!x) return std::nullopt;
        result[k] = *x + 0.0;
    }
    return result;
}

Fractions ExactPoints::exact_crossing(const Crossing& crossing) const {
    const auto [p, q, a, b, c] = crossing.of;
    const Fractions o = exact(a), u = minus(exact(b), o), v = minus(exact(c), o);
    const Fractions start = exact(p), way = minus(exact(q), start);
    const mpq_class share = -determinant(u, v, minus(start, o)) / determinant(u, v, way);
    Fractions found;
    for (std::size_t k = 0; k < 3; ++k)
        found[k] = start[k] + share * way[k];
    return found;
}

NodeId ExactPoints::crossing(std::size_t axis, NodeId p, NodeId q, NodeId a, NodeId b) {
    const Fractions o = exact(a), u = minus(exact(b), o);
    const Fractions start = exact(p), way = minus(exact(q), start);
    const mpq_class from = cross(u, minus(start, o), axis), change = cross(u, way, axis);
    const mpq_class share = -from / change;
    return add(Fractions{mpq_class(start[0] + share * way[0]), mpq_class(start[1] + share * way[1]),
                         mpq_class(start[2] + share * way[2])});
}

NodeId ExactPoints::dropped(std::size_t axis, NodeId p, NodeId a, NodeId b, NodeId c) {
    const Fractions o = exact(a), u = minus(exact(b), o), v = minus(exact(c), o);
    Fractions at = exact(p);
    const mpq_class off = determinant(u, v, minus(at, o)), normal = cross(u, v, axis);
    at[axis] -= off / normal;
    return add(std::move(at));
}

NodeId ExactPoints::dropped(std::size_t axis, NodeId p, NodeId a, NodeId b) {
    const Fractions o = exact(a), u = minus(exact(b), o), at = exact(p);
    const mpq_class share = (at[axis] - o[axis]) / u[axis];
    return add(Fractions{mpq_class(o[0] + share * u[0]), mpq_class(o[1] + share * u[1]),
                         mpq_class(o[2] + share * u[2])});
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

NodeId ExactPoints::middle(const std::array<NodeId, 3>& corners) {
    const Fractions a = exact(corners[0]), b = exact(corners[1]), c = exact(corners[2]);
    Fractions sum;
    for (std::size_t k = 0; k < 3; ++k)
        sum[k] = (a[k] + b[k] + c[k]) / 3;
    return add(std::move(sum));
}

bool ExactPoints::is_farther(std::size_t axis, NodeId a, NodeId b, NodeId p, NodeId q) const {
    const Fractions o = exact(a), way = minus(exact(b), o);
    return abs(cross(way, minus(exact(p), o), axis)) > abs(cross(way, minus(exact(q), o), axis));
}

}  // namespace realmodel::cutting
