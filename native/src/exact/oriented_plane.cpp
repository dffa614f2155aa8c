// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/oriented_plane.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/floating_point.hpp"
#include "exact/arithmetic.hpp"
#include "exact/orientation.hpp"

namespace realmodel::exact {

OrientedPlane::OrientedPlane(const SpacePosition& point, const SpacePosition& normal)
    : point_(point), normal_(normal) {
    double largest = 0;
    for (const double n : normal_)
        largest = std::max(largest, std::abs(n));
    assert(largest > 0 && std::isfinite(largest));
    int exponent = 0;
    std::frexp(largest, &exponent);
    for (double& n : normal_)
        n = std::ldexp(n, -exponent);  // the same direction, and nothing overflows
}

double OrientedPlane::rounding(const SpacePosition& p) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
        sum += std::abs(normal_[k]) * ulp(p[k]);
    return kComputedUlps * sum;
}

DoubleDoubleInterval OrientedPlane::distance(const SpacePosition& p) const {
    DoubleDoubleInterval sum;
    for (std::size_t k = 0; k < 3; ++k)
        sum = sum +
              DoubleDoubleInterval(normal_[k]) * DoubleDoubleInterval::difference(p[k], point_[k]);
    return sum;
}

mpq_class OrientedPlane::exact_distance(const SpacePosition& p) const {
    mpq_class sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
        sum += mpq_class(normal_[k]) * (mpq_class(p[k]) - mpq_class(point_[k]));
    return sum;
}

RationalPoint OrientedPlane::exact_intersection(const SpacePosition& p,
                                                const SpacePosition& q) const {
    const mpq_class from = exact_distance(p), change = from - exact_distance(q);
    assert(change != 0);
    const auto rational = [](const SpacePosition& r) {
        return RationalPoint{mpq_class(r[0]), mpq_class(r[1]), mpq_class(r[2])};
    };
    return interpolated(rational(p), rational(q), mpq_class(from / change));
}

// A coordinate has to be right to its own last place, however much smaller than the ends of the
// line it is: a cap is flat only if all of its corners are where the plane is, on every axis.
SpacePosition OrientedPlane::intersection(const SpacePosition& p, const SpacePosition& q) const {
    const DoubleDoubleInterval from = distance(p), ratio = from / (from - distance(q));
    SpacePosition result;
    for (std::size_t k = 0; k < 3; ++k) {
        if (normal_[(k + 1) % 3] == 0 && normal_[(k + 2) % 3] == 0) {
            result[k] = point_[k] + 0.0;  // of both zeros the one without a sign
            continue;
        }
        auto x = (DoubleDoubleInterval(p[k]) + ratio * DoubleDoubleInterval::difference(q[k], p[k]))
                     .rounded();
        if (!x) {
            const mpq_class exact = exact_intersection(p, q)[k];
            x = nearest_double(exact.get_num(), exact.get_den(), 0);
        }
        result[k] = *x + 0.0;
    }
    return result;
}

// The rounding of differences, products and their sum makes 5 * 2^-53 of the products' sizes at
// most, and an underflow loses no more than kUnderflow.
std::int8_t OrientedPlane::side(const SpacePosition& p) const {
    constexpr double kRounding = 0x1p-50;
    double sum = 0, size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double term = normal_[k] * (p[k] - point_[k]);
        sum += term;
        size += std::abs(term);
    }
    if (std::abs(sum) > kRounding * size + kUnderflow) return sum > 0 ? 1 : -1;
    const auto sign = distance(p).sign();
    return static_cast<std::int8_t>(sign ? *sign : sgn(exact_distance(p)));
}

bool OrientedPlane::is_beside(const SpacePosition& p) const {
    const double off = std::abs(distance(p).high);
    for (std::size_t k = 0; k < 3; ++k) {
        if (off <= std::abs(normal_[k]) * ulp(p[k]) / 2) return true;
    }
    return false;
}

}  // namespace realmodel::exact
