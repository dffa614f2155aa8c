// SPDX-License-Identifier: GPL-3.0-or-later
/// CGAL's kernel of exact predicates, without MPFR; to be included before what else of CGAL is.
///
/// CGAL's exact constructions ask MPFR for the two doubles around a fraction (CGAL/mpq_class.h),
/// and for nothing else. GMP alone does that, so that MPFR is not linked. Its other functions must
/// not be called after this.
#pragma once

#include <gmp.h>
#include <mpfr.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace realmodel::exact {

/// `exact` rounded away from zero, kept as a double in the first limb of `rounded`.
/// @return 0 where it is a double, else not 0
inline int round_away(mpfr_t& rounded, mpq_srcptr exact) {
    double value = mpq_get_d(exact);  // rounded to zero
    bool is_exact = false;
    if (std::isfinite(value)) {
        mpq_t truncated;
        mpq_init(truncated);
        mpq_set_d(truncated, value);
        is_exact = mpq_equal(truncated, exact) != 0;
        mpq_clear(truncated);
        if (!is_exact)
            value = std::nextafter(value, mpq_sgn(exact) * std::numeric_limits<double>::infinity());
    }
    static_assert(sizeof(mp_limb_t) >= sizeof(double));
    std::memcpy(rounded->_mpfr_d, &value, sizeof(value));
    return is_exact ? 0 : mpq_sgn(exact);
}

inline double rounded_away(mpfr_srcptr rounded) {
    double value = 0;
    std::memcpy(&value, rounded->_mpfr_d, sizeof(value));
    return value;
}

}  // namespace realmodel::exact

// NOLINTBEGIN: names of MPFR
#undef mpfr_get_emin
#undef mpfr_set_emin
#undef mpfr_set_q
#undef mpfr_subnormalize
#undef mpfr_get_d
#define mpfr_get_emin() \
    mpfr_exp_t {        \
        0               \
    }
#define mpfr_set_emin(exponent) static_cast<void>(exponent)
#define mpfr_set_q(rounded, fraction, way) realmodel::exact::round_away(rounded, fraction)
#define mpfr_subnormalize(rounded, inexact, way) (inexact)
#define mpfr_get_d(rounded, way) realmodel::exact::rounded_away(rounded)
// NOLINTEND

// A sum of its numbers (CGAL 5.5) begins with storage that is not set: where there is no memory its
// destructor would free an address left to chance.
#pragma push_macro("noalloc")
#define noalloc() Mpzf(allocate(), 0)
#include <CGAL/Mpzf.h>
#pragma pop_macro("noalloc")

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
