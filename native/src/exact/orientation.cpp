// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/orientation.hpp"

#include "exact/arithmetic.hpp"

namespace realmodel::exact {

int orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b,
             const std::array<double, 2>& c) {
    if (const auto sign = orient2d_filter(a, b, c)) return *sign;
    if (a == b || b == c || a == c) return 0;
    // a difference is 0 only where doubles are equal, as along borders parallel to an axis
    if ((a[0] == b[0] || a[1] == c[1]) && (a[1] == b[1] || a[0] == c[0])) return 0;
    int unit = 0;
    for (const auto& p : {a, b, c})
        unit = finest_exponent(p[1], finest_exponent(p[0], unit));
    const auto d = [&](double p, double q) { return whole_difference(p, q, unit); };
    return sgn(mpz_class(d(b[0], a[0]) * d(c[1], a[1]) - d(b[1], a[1]) * d(c[0], a[0])));
}

bool in_one_line(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c) {
    for (const auto& [i, j] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
        if (orient2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}) != 0) return false;
    }
    return true;
}

}  // namespace realmodel::exact
