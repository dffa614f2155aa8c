// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

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
class ShortArithmetic {
public:
    explicit ShortArithmetic(const PlanArrangement& geometry)
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

}  // namespace realmodel::exact
