// SPDX-License-Identifier: GPL-3.0-or-later
// How points come to be known. What is asked of them is in exact_signs.cpp.
#include "cutting/exact_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "cutting/fractions.hpp"
#include "cutting/wide_places.hpp"
#include "exact/arithmetic.hpp"

namespace realmodel::cutting {

using exact::DoubleDoubleInterval;

namespace {

std::uint64_t hash_of(const Position& p) {
    std::array<std::uint64_t, 3> words;
    for (std::size_t k = 0; k < 3; ++k)
        words[k] = std::bit_cast<std::uint64_t>(p[k] + 0.0);  // both zeros alike
    return NodeTable::hash(words);
}

}  // namespace

/// The number of a point that is the same as the last one, or -1.
NodeId ExactPoints::find_equal(NodeId p) const {
    return known_.find(hash_of(rounded(p)), [this, p](NodeId other) {
        if (rounded(other) != rounded(p)) return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (compare(axis, p, other) != 0) return false;
        }
        return true;
    });
}

/// The number of a point: a new one where none is the same. Leaves what it was made of with new
/// points only.
NodeId ExactPoints::enter(const Position& rounded, Source source) {
    const auto number = static_cast<NodeId>(rounded_.size());
    rounded_.push_back(rounded);
    source_.push_back(source);
    const NodeId known = find_equal(number);
    if (known < 0) {
        known_.insert(hash_of(rounded), number);
        return number;
    }
    rounded_.pop_back();
    source_.pop_back();
    if (source.kind == Source::Kind::kMade) made_.pop_back();
    if (source.kind == Source::Kind::kFractions) fractions_.pop_back();
    return known;
}

NodeId ExactPoints::add(const Position& p) {
    return enter({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, {});
}

NodeId ExactPoints::add(Fractions&& p) {
    Position rounded;
    bool doubles = true;
    for (std::size_t k = 0; k < 3; ++k) {
        p[k].canonicalize();
        rounded[k] = exact::nearest_double(p[k].get_num(), p[k].get_den(), 0);
        doubles = doubles && mpq_class(rounded[k]) == p[k];
    }
    if (doubles) return enter(rounded, {});
    fractions_.push_back(std::move(p));
    return enter(rounded,
                 {Source::Kind::kFractions, static_cast<std::int32_t>(fractions_.size()) - 1});
}

Fractions ExactPoints::exact(NodeId p) const {
    const Source& source = source_[index(p)];
    if (source.kind == Source::Kind::kFractions) return fractions_[index(source.number)];
    if (const Made* made = this->made(p)) return exact_crossing(made->crossing);
    const Position& r = rounded(p);
    return {mpq_class(r[0]), mpq_class(r[1]), mpq_class(r[2])};
}

bool ExactPoints::was_made_on(NodeId p, NodeId a, NodeId b) const {
    const Made* made = this->made(p);
    return made != nullptr && made->crossing.is_on_line(std::min(a, b), std::max(a, b));
}

NodeId ExactPoints::crossing(NodeId p, NodeId q, NodeId a, NodeId b, NodeId c) {
    // triangles that share an edge ask for the same place
    std::array<NodeId, 3> plane{a, b, c};
    std::sort(plane.begin(), plane.end());
    const Crossing crossing{{std::min(p, q), std::max(p, q), plane[0], plane[1], plane[2]}};
    const std::uint64_t hash = NodeTable::hash(crossing.of);
    const std::int32_t named = crossings_.find(
        hash, [&](std::int32_t name) { return crossing_names_[index(name)].first == crossing; });
    if (named >= 0) return crossing_names_[index(named)].second;
    const NodeId number = make(crossing);
    crossings_.insert(hash, static_cast<std::int32_t>(crossing_names_.size()));
    crossing_names_.push_back({crossing, number});
    return number;
}

/// The point of a crossing that has no number by its name.
NodeId ExactPoints::make(const Crossing& crossing) {
    const bool of_doubles = std::all_of(crossing.of.begin(), crossing.of.end(),
                                        [this](NodeId node) { return is_double(node); });
    if (!of_doubles) return add(exact_crossing(crossing));
    const auto at = place(crossing);
    Position rounded;
    bool may_be_doubles = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto x = at[k].rounded();
        if (!x) return add(exact_crossing(crossing));
        rounded[k] = *x + 0.0;
        may_be_doubles = may_be_doubles && at[k].low == 0;
    }
    if (may_be_doubles) {
        const auto are_doubles = Wide(*this, crossing).is_at(crossing, rounded);
        if (!are_doubles) return add(exact_crossing(crossing));
        if (*are_doubles) return enter(rounded, {});
    }
    made_.push_back({crossing, at});
    return enter(rounded, {Source::Kind::kMade, static_cast<std::int32_t>(made_.size()) - 1});
}

/// The coordinates of a crossing of what is given by doubles. What lies across an axis has that
/// coordinate exactly.
std::array<DoubleDoubleInterval, 3> ExactPoints::place(const Crossing& crossing) const {
    const auto minus = [this](NodeId p, NodeId q) {
        std::array<DoubleDoubleInterval, 3> way;
        for (std::size_t k = 0; k < 3; ++k)
            way[k] = DoubleDoubleInterval::difference(rounded(p)[k], rounded(q)[k]);
        return way;
    };
    const auto [p, q, a, b, c] = crossing.of;
    const auto u = minus(b, a), v = minus(c, a), way = minus(q, p), start = minus(p, a);
    DoubleDoubleInterval from, change;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        const DoubleDoubleInterval normal = u[l] * v[m] - u[m] * v[l];
        from = from + normal * start[k];
        change = change + normal * way[k];
    }
    const DoubleDoubleInterval share = -from / change;
    std::array<DoubleDoubleInterval, 3> result;
    for (std::size_t k = 0; k < 3; ++k) {
        if (way[k].is_exact_zero()) {
            result[k] = DoubleDoubleInterval(rounded(p)[k]);
        } else if (u[k].is_exact_zero() && v[k].is_exact_zero()) {
            result[k] = DoubleDoubleInterval(rounded(a)[k]);
        } else {
            result[k] = DoubleDoubleInterval(rounded(p)[k]) + share * way[k];
        }
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

NodeId ExactPoints::middle(const std::array<NodeId, 3>& corners) {
    const Fractions a = exact(corners[0]), b = exact(corners[1]), c = exact(corners[2]);
    Fractions sum;
    for (std::size_t k = 0; k < 3; ++k)
        sum[k] = (a[k] + b[k] + c[k]) / 3;
    return add(std::move(sum));
}

}  // namespace realmodel::cutting
