// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/orient2d.hpp"

#include "exact/arithmetic.hpp"
#include "exact/sign_filters.hpp"

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

}  // namespace realmodel::exact
