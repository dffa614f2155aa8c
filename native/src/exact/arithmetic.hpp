// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include "exact/double_double_interval.hpp"
#include "exact/int126.hpp"
#include "exact/plan_arrangement.hpp"

namespace realmodel::exact {

/// A double as a whole multiple of 2^exponent, which it must be.
mpz_class whole_number(double value, int exponent);
/// p - q in units of 2^exponent, of which both must be whole multiples.
mpz_class whole_difference(double p, double q, int exponent);

/// num / den * 2^exponent as the nearest double, ties to even.
double nearest_double(mpz_class num, mpz_class den, int exponent);

/// The largest exponent (at most `exponent`) that makes a double a whole multiple of 2^exponent.
int finest_exponent(double value, int exponent);

/// Input differences as whole numbers: plan in units of 2^plan_exponent, heights likewise.
struct IntegerArithmetic {
    const PlanArrangement& g;
    mpz_class dx(VertexId v, VertexId o) const {
        return whole_difference(g.point(v).x, g.point(o).x, g.plan_exponent());
    }
    mpz_class dy(VertexId v, VertexId o) const {
        return whole_difference(g.point(v).y, g.point(o).y, g.plan_exponent());
    }
    mpz_class dz(SpaceId s, SpaceId t) const {
        return whole_difference(g.space(s).z, g.space(t).z, g.height_exponent());
    }
    mpz_class plan(double value) const { return whole_number(value, g.plan_exponent()); }
    mpz_class height(double value) const { return whole_number(value, g.height_exponent()); }
};

inline bool is_known(const mpz_class&) {
    return true;
}
inline int sign_of(const mpz_class& number) {
    return sgn(number);
}
inline int sign_of(double value) {
    return value > 0.0 ? 1 : (value < 0.0 ? -1 : 0);
}
inline double nearest_double(const Int126& num, const Int126& den, int exponent) {
    return nearest_double(num.to_mpz(), den.to_mpz(), exponent);
}

/// The answer to a question of whole numbers.
/// @param ask  ask(in, number) gives the answer in the arithmetic `in` and the kind of number, or
///             nothing where the numbers it comes from are not known: they are short ones first
template <class Ask>
auto exactly(const PlanArrangement& geometry, const Ask& ask) {
    if (const auto answer = ask(ShortArithmetic(geometry), Int126())) return *answer;
    return *ask(IntegerArithmetic{geometry}, mpz_class());
}

/// Input differences to twice the precision of doubles.
struct BallArithmetic {
    const PlanArrangement& g;
    DoubleDoubleInterval dx(VertexId v, VertexId o) const {
        return DoubleDoubleInterval::difference(g.point(v).x, g.point(o).x);
    }
    DoubleDoubleInterval dy(VertexId v, VertexId o) const {
        return DoubleDoubleInterval::difference(g.point(v).y, g.point(o).y);
    }
    DoubleDoubleInterval dz(SpaceId s, SpaceId t) const {
        return DoubleDoubleInterval::difference(g.space(s).z, g.space(t).z);
    }
};

}  // namespace realmodel::exact
