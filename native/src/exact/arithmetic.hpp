// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "exact/double_double_interval.hpp"
#include "exact/local_arrangement.hpp"
#include "exact/plan_arrangement.hpp"

namespace realmodel::exact {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 UInt128;

/// A number as GMP's, whose own constructors take a `long`: on Windows 32 bits.
inline mpz_class whole_number_of(Int128 number) {
    const UInt128 size = number < 0 ? -static_cast<UInt128>(number) : static_cast<UInt128>(number);
    const std::array words{static_cast<std::uint64_t>(size),
                           static_cast<std::uint64_t>(size >> 64)};
    mpz_class result;
    mpz_import(result.get_mpz_t(), words[1] == 0 ? 1 : 2, -1, sizeof words[0], 0, 0, words.data());
    if (number < 0) mpz_neg(result.get_mpz_t(), result.get_mpz_t());
    return result;
}

/// A whole number of up to 126 bits, with a bound on how many it has: one that might have more is
/// not known. Input on a lattice gives small numbers, where every tie is asked exactly; they need
/// no memory of their own.
class Int126 {
public:
    Int126() = default;
    explicit Int126(int value) : Int126(static_cast<std::int64_t>(value)) {}
    explicit Int126(std::int64_t value)
        : value_(value), bits_(std::bit_width(static_cast<std::uint64_t>(std::abs(value)))) {}
    static Int126 unknown() { return {0, kMostBits + 1}; }
    /// a - b in units of 1 / scale, a power of two that makes both of them whole.
    static Int126 difference(double a, double b, double scale) {
        constexpr double kMost = 0x1p61;
        const double p = a * scale, q = b * scale;
        if (!(std::abs(p) < kMost && std::abs(q) < kMost)) return Int126::unknown();
        return Int126(static_cast<std::int64_t>(p) - static_cast<std::int64_t>(q));
    }

    friend bool is_known(const Int126& a) { return a.bits_ <= kMostBits; }
    friend int sign_of(const Int126& a) { return a.value_ > 0 ? 1 : (a.value_ < 0 ? -1 : 0); }
    mpz_class to_mpz() const { return whole_number_of(value_); }

    friend Int126 operator-(const Int126& a) { return {-a.value_, a.bits_}; }
    friend Int126 operator+(const Int126& a, const Int126& b) {
        const int bits = (a.bits_ > b.bits_ ? a.bits_ : b.bits_) + 1;
        return bits <= kMostBits ? Int126(a.value_ + b.value_, bits) : unknown();
    }
    friend Int126 operator-(const Int126& a, const Int126& b) { return a + -b; }
    friend Int126 operator*(const Int126& a, const Int126& b) {
        if (!is_known(a) || !is_known(b)) return unknown();
        if (a.value_ == 0 || b.value_ == 0) return {};
        const int bits = a.bits_ + b.bits_;
        return bits <= kMostBits ? Int126(a.value_ * b.value_, bits) : unknown();
    }

private:
    static constexpr int kMostBits = 126;
    Int126(Int128 value, int bits) : value_(value), bits_(bits) {}

    Int128 value_ = 0;
    int bits_ = 0;  ///< its size is below 2^bits_
};

/// Input differences as short integers, in the units of IntegerArithmetic.
class Int126Arithmetic {
public:
    explicit Int126Arithmetic(const PlanArrangement& geometry)
        : g_(geometry),
          plan_scale_(std::ldexp(1.0, -geometry.plan_exponent())),
          height_scale_(std::ldexp(1.0, -geometry.height_exponent())) {}

    Int126 dx(VertexId v, VertexId o) const {
        return Int126::difference(g_.point(v).x, g_.point(o).x, plan_scale_);
    }
    Int126 dy(VertexId v, VertexId o) const {
        return Int126::difference(g_.point(v).y, g_.point(o).y, plan_scale_);
    }
    Int126 dz(SpaceId s, SpaceId t) const {
        return Int126::difference(g_.space(s).z, g_.space(t).z, height_scale_);
    }
    Int126 plan(double value) const { return Int126::difference(value, 0.0, plan_scale_); }
    Int126 height(double value) const { return Int126::difference(value, 0.0, height_scale_); }

private:
    const PlanArrangement& g_;
    double plan_scale_, height_scale_;
};

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
    if (const auto answer = ask(Int126Arithmetic(geometry), Int126())) return *answer;
    return *ask(IntegerArithmetic{geometry}, mpz_class());
}

/// Input differences to twice the precision of doubles.
struct DoubleDoubleArithmetic {
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

// The formulas of plan lines, crossings and heights, written once for every kind of number. An
// `Arithmetic` gives differences of input coordinates in its number type: dx(v, o), dy(v, o) of
// plan vertices and dz(s, t) of space vertices. Differences first keep numbers short far from the
// origin.

template <class Number>
struct LineCoefficients {
    Number a, b, c;
};

/// X / W and Y / W are a position relative to an origin.
template <class Number>
struct Homogeneous {
    Number x, y, w;
};

template <class Number>
struct Normal {
    Number a, b, c;
};

template <class Number, class Arithmetic>
Normal<Number> plane_normal(const Arithmetic& in, const PlanArrangement& g, PlaneId id) {
    const auto& corner = g.plane(id).corner;
    const VertexId p0 = g.space(corner[0]).plan, p1 = g.space(corner[1]).plan,
                   p2 = g.space(corner[2]).plan;
    const Number ux = in.dx(p1, p0), uy = in.dy(p1, p0), uz = in.dz(corner[1], corner[0]);
    const Number vx = in.dx(p2, p0), vy = in.dy(p2, p0), vz = in.dz(corner[2], corner[0]);
    return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

/// a x + b y + c of a line relative to the plan vertex `origin`.
template <class Number, class Arithmetic>
LineCoefficients<Number> line_coefficients(const Arithmetic& in, const PlanArrangement& g,
                                           const Line& line, VertexId origin) {
    if (line.is_edge()) {
        const auto [from, to] = line.ends();
        const Number a = in.dy(from, to), b = in.dx(to, from);
        const Number px = in.dx(from, origin), py = in.dy(from, origin);
        return {a, b, Number(-(a * px + b * py))};
    }
    // h(x, y) = -(A (x - x0) + B (y - y0)) / C + z0 for either plane; C is positive, so the sign of
    // the difference of heights is that of the difference of the numerators.
    const auto [first, second] = line.planes();
    const Normal<Number> p = plane_normal<Number>(in, g, first);
    const Normal<Number> q = plane_normal<Number>(in, g, second);
    const SpaceId sp = g.plane(first).corner[0], sq = g.plane(second).corner[0];
    const VertexId vp = g.space(sp).plan, vq = g.space(sq).plan;
    const Number offset_p = p.a * in.dx(vp, origin) + p.b * in.dy(vp, origin);
    const Number offset_q = q.a * in.dx(vq, origin) + q.b * in.dy(vq, origin);
    const Number rise = in.dz(sp, sq);
    return {Number(q.a * p.c - p.a * q.c), Number(q.b * p.c - p.b * q.c),
            Number(offset_p * q.c - offset_q * p.c + rise * (p.c * q.c))};
}

/// The crossing of two lines, relative to the origin that both are relative to.
template <class Number>
Homogeneous<Number> cross(const LineCoefficients<Number>& l, const LineCoefficients<Number>& m) {
    return {Number(l.b * m.c - m.b * l.c), Number(l.c * m.a - m.c * l.a),
            Number(l.a * m.b - m.a * l.b)};
}

/// A point of a scope relative to a plan vertex.
template <class Number, class Arithmetic>
Homogeneous<Number> position_of(const Arithmetic& in, const LocalArrangement& scope, PointId id,
                                VertexId origin) {
    if (scope.is_vertex(id)) {
        const VertexId v = scope.vertex(id);
        return {in.dx(v, origin), in.dy(v, origin), Number(1)};
    }
    const Point& p = scope.point(id);
    return cross(line_coefficients<Number>(in, scope.shared(), scope.line(p.first), origin),
                 line_coefficients<Number>(in, scope.shared(), scope.line(p.second), origin));
}

/// A plan vertex that a line starts from.
inline VertexId anchor(const PlanArrangement& g, const Line& line) {
    return line.is_edge() ? line.ends()[0] : g.space(g.plane(line.planes()[0]).corner[0]).plan;
}

}  // namespace realmodel::exact
