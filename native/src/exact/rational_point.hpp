// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>

namespace realmodel::exact {

/// A point of space, or the difference of two, in rational coordinates.
using RationalPoint = std::array<mpq_class, 3>;

inline RationalPoint minus(const RationalPoint& a, const RationalPoint& b) {
    return {mpq_class(a[0] - b[0]), mpq_class(a[1] - b[1]), mpq_class(a[2] - b[2])};
}

inline mpq_class determinant(const RationalPoint& u, const RationalPoint& v,
                             const RationalPoint& w) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/// The component of a cross product along an axis.
inline mpq_class cross(const RationalPoint& u, const RationalPoint& v, std::size_t axis) {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    return u[k] * v[l] - u[l] * v[k];
}

/// The point that divides the line from p to q, beginning at p, in this ratio.
inline RationalPoint interpolated(const RationalPoint& p, const RationalPoint& q,
                                  const mpq_class& ratio) {
    RationalPoint result;
    for (std::size_t k = 0; k < 3; ++k)
        result[k] = p[k] + ratio * (q[k] - p[k]);
    return result;
}

}  // namespace realmodel::exact
