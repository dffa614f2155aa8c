// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/space_points.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "exact/arithmetic.hpp"
#include "exact/homogeneous_points.hpp"
#include "exact/orientation.hpp"

namespace realmodel::exact {

/// The number of a point: a new one where none is the same. Only new points keep their source.
SpacePointId SpacePoints::enter(const SpacePosition& rounded, Source source) {
    const SpacePointId number(checked_number(rounded_.size(), "points where surfaces meet"));
    rounded_.push_back(rounded);
    source_.push_back(source);
    const auto entry = by_doubles_.find_or_add(
        KeyNumbers<SpacePosition>::hash(rounded), number.number(), [&](std::int32_t candidate) {
            const SpacePointId other(candidate);
            return rounded_[index(other)] == rounded && compare(*this, number, other) == 0;
        });
    if (entry.is_new) return number;
    rounded_.pop_back();
    source_.pop_back();
    if (source.kind == Source::Form::kConstruction) constructions_.pop_back();
    if (source.kind == Source::Form::kFractions) fractions_.pop_back();
    return SpacePointId(entry.number);
}

SpacePointId SpacePoints::add(const SpacePosition& p) {
    assert(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]));
    return enter({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, {});
}

SpacePointId SpacePoints::add(RationalPoint&& p) {
    Fractions fractions;
    fractions.weight = 1;
    for (mpq_class& x : p) {
        x.canonicalize();
        fractions.weight = lcm(fractions.weight, x.get_den());
    }
    for (std::size_t k = 0; k < 3; ++k)
        fractions.at[k] = p[k].get_num() * (fractions.weight / p[k].get_den());
    return add(reduced(std::move(fractions)));
}

/// A point of which `at`, `weight` and `lines` are set.
SpacePoints::Reduced SpacePoints::reduced(Fractions&& p) {
    mpz_class common = gcd(p.weight, p.at[0]);
    for (std::size_t k = 1; k < 3; ++k) {
        if (common != 1) common = gcd(common, p.at[k]);
    }
    if (p.weight < 0) common = -common;
    p.weight /= common;
    SpacePosition rounded;
    bool are_doubles = true;
    for (std::size_t k = 0; k < 3; ++k) {
        p.at[k] /= common;
        rounded[k] = nearest_double(p.at[k], p.weight, 0);
        const mpq_class high(rounded[k]);
        const mpz_class rest = p.at[k] * high.get_den() - high.get_num() * p.weight;
        p.interval[k] = DoubleDoubleInterval(rounded[k]);
        if (rest == 0) continue;
        are_doubles = false;
        const double low = nearest_double(rest, p.weight * high.get_den(), 0);
        p.interval[k] = {rounded[k], low, std::abs(low) * kEpsilon + kDoubleDoubleUnderflow};
    }
    return {std::move(p), rounded, are_doubles};
}

SpacePointId SpacePoints::add(Reduced&& p) {
    if (p.are_doubles) return enter(p.rounded, {});
    fractions_.push_back(std::move(p.fractions));
    return enter(p.rounded,
                 {Source::Form::kFractions, static_cast<std::int32_t>(fractions_.size()) - 1});
}

RationalPoint SpacePoints::exact(SpacePointId p) const {
    const SpacePosition& r = rounded(p);
    if (is_double(p)) return {mpq_class(r[0]), mpq_class(r[1]), mpq_class(r[2])};
    const HomogeneousPoints<mpz_class> in(*this, std::array{p});
    const auto point = in.absolute(in.point(p));
    RationalPoint result;
    for (std::size_t k = 0; k < 3; ++k) {
        result[k] = mpq_class(point.at[k], point.weight);
        result[k].canonicalize();
    }
    return result;
}

std::array<SpacePoints::SpaceLine, 2> SpacePoints::lines(SpacePointId p) const {
    if (const Fractions* point = fractions(p)) return point->lines;
    const SpaceLine none{kNone, kNone};
    const ConstructedPoint* point = construction(p);
    return {point == nullptr ? none : SpaceLine{point->of.of[0], point->of.of[1]}, none};
}

bool SpacePoints::was_constructed_on(SpacePointId p, SpacePointId a, SpacePointId b) const {
    const SpaceLine line{std::min(a, b), std::max(a, b)};
    const auto supporting_lines = lines(p);
    return supporting_lines[0] == line || supporting_lines[1] == line;
}

void SpacePoints::reserve(std::size_t more) {
    reserve_more(rounded_, more);
    reserve_more(source_, more);
    by_doubles_.reserve(rounded_.size() + more);
}

void SpacePoints::reserve_intersections(std::size_t more) {
    reserve(more);
    reserve_more(constructions_, more);
    reserve_more(intersections_, more);
    by_intersection_.reserve(intersections_.size() + more);
}

SpacePointId SpacePoints::intersection(SpacePointId p, SpacePointId q, SpacePointId a,
                                       SpacePointId b, SpacePointId c) {
    assert(orient3d(*this, a, b, c, p) * orient3d(*this, a, b, c, q) <= 0);
    // triangles that share an edge ask for the same point
    std::array<SpacePointId, 3> plane{a, b, c};
    std::sort(plane.begin(), plane.end());
    const Intersection of{{std::min(p, q), std::max(p, q), plane[0], plane[1], plane[2]}};
    const auto entry = by_intersection_.find_or_add(
        KeyNumbers<decltype(of.of)>::hash(of.of), static_cast<std::int32_t>(intersections_.size()),
        [&](std::int32_t i) { return intersections_[index(i)].first == of; });
    if (entry.is_new) intersections_.push_back({of, construct(of)});
    return intersections_[index(entry.number)].second;
}

SpacePointId SpacePoints::construct(const Intersection& of) {
    const bool of_doubles =
        std::all_of(of.of.begin(), of.of.end(), [this](SpacePointId p) { return is_double(p); });
    if (!of_doubles) return in_fractions(of);
    const auto at = coordinates(of);
    SpacePosition rounded;
    bool may_be_doubles = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto x = at[k].rounded();
        if (!x) return in_fractions(of);
        rounded[k] = *x + 0.0;
        may_be_doubles = may_be_doubles && at[k].low == 0;
    }
    if (may_be_doubles) {
        const auto are_doubles =
            by_integers(*this, of.of, [&](auto&& in) { return in.is_at(of, rounded); });
        if (are_doubles) return enter(rounded, {});
    }
    constructions_.push_back({of, at});
    return enter(rounded, {Source::Form::kConstruction,
                           static_cast<std::int32_t>(constructions_.size()) - 1});
}

/// The coordinates of an intersection of points given by doubles. A line or plane across an axis
/// gives its coordinate exactly.
std::array<DoubleDoubleInterval, 3> SpacePoints::coordinates(const Intersection& of) const {
    const auto minus = [this](SpacePointId p, SpacePointId q) {
        std::array<DoubleDoubleInterval, 3> difference;
        for (std::size_t k = 0; k < 3; ++k)
            difference[k] = DoubleDoubleInterval::difference(rounded(p)[k], rounded(q)[k]);
        return difference;
    };
    const auto [p, q, a, b, c] = of.of;
    const auto u = minus(b, a), v = minus(c, a), line = minus(q, p), start = minus(p, a);
    DoubleDoubleInterval from, change;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        const DoubleDoubleInterval normal = u[l] * v[m] - u[m] * v[l];
        from = from + normal * start[k];
        change = change + normal * line[k];
    }
    const DoubleDoubleInterval ratio = -from / change;
    std::array<DoubleDoubleInterval, 3> result;
    for (std::size_t k = 0; k < 3; ++k) {
        if (line[k].is_exact_zero()) {
            result[k] = DoubleDoubleInterval(rounded(p)[k]);
        } else if (u[k].is_exact_zero() && v[k].is_exact_zero()) {
            result[k] = DoubleDoubleInterval(rounded(a)[k]);
        } else {
            result[k] = DoubleDoubleInterval(rounded(p)[k]) + ratio * line[k];
        }
    }
    return result;
}

SpacePointId SpacePoints::in_fractions(const Intersection& of) {
    const HomogeneousPoints<mpz_class> in(*this, of.of);
    auto point = in.absolute(in.point(of));
    const SpaceLine line{of.of[0], of.of[1]};
    return add(reduced(
        {std::move(point.at), std::move(point.weight), {}, {line, SpaceLine{kNone, kNone}}}));
}

SpacePoints::Reduced SpacePoints::crossing(std::size_t axis, SpacePointId p, SpacePointId q,
                                           SpacePointId a, SpacePointId b) const {
    const HomogeneousPoints<mpz_class> in(*this, std::array{p, q, a, b});
    auto point = in.absolute(in.crossing(axis, p, q, a, b));
    return reduced(
        {std::move(point.at),
         std::move(point.weight),
         {},
         {SpaceLine{std::min(p, q), std::max(p, q)}, SpaceLine{std::min(a, b), std::max(a, b)}}});
}

SpacePointId SpacePoints::projected(std::size_t axis, SpacePointId p, SpacePointId a,
                                    SpacePointId b, SpacePointId c) {
    const RationalPoint o = exact(a), u = minus(exact(b), o), v = minus(exact(c), o);
    RationalPoint at = exact(p);
    const mpq_class normal = cross(u, v, axis);
    assert(normal != 0);
    at[axis] -= dot(cross(u, v), minus(at, o)) / normal;
    return add(std::move(at));
}

SpacePointId SpacePoints::projected(std::size_t axis, SpacePointId p, SpacePointId a,
                                    SpacePointId b) {
    const RationalPoint from = exact(a), to = exact(b);
    assert(from[axis] != to[axis]);
    return add(
        interpolated(from, to, mpq_class((exact(p)[axis] - from[axis]) / (to[axis] - from[axis]))));
}

SpacePointId SpacePoints::middle(const std::array<SpacePointId, 3>& corners) {
    const RationalPoint a = exact(corners[0]), b = exact(corners[1]), c = exact(corners[2]);
    RationalPoint sum;
    for (std::size_t k = 0; k < 3; ++k)
        sum[k] = (a[k] + b[k] + c[k]) / 3;
    return add(std::move(sum));
}

}  // namespace realmodel::exact
