// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>

namespace realmodel::cutting {

/// A place, or a way between two, as fractions.
using Fractions = std::array<mpq_class, 3>;

inline Fractions minus(const Fractions& a, const Fractions& b) {
    return {mpq_class(a[0] - b[0]), mpq_class(a[1] - b[1]), mpq_class(a[2] - b[2])};
}

inline mpq_class determinant(const Fractions& u, const Fractions& v, const Fractions& w) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

inline mpq_class cross(const Fractions& u, const Fractions& v, std::size_t axis) {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    return u[k] * v[l] - u[l] * v[k];
}

}  // namespace realmodel::cutting
