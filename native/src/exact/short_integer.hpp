// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmpxx.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "realmodel/exact/plan_geometry.hpp"

namespace realmodel::exact {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 UInt128;

/// A whole number of up to 126 bits, with a bound on how many it has: one that might have more is
/// not known. Input on a lattice gives small numbers, where every tie is asked exactly; they need
/// no memory of their own.
class ShortInteger {
public:
    ShortInteger() = default;
    explicit ShortInteger(int value) : ShortInteger(static_cast<std::int64_t>(value)) {}
    explicit ShortInteger(std::int64_t value)
        : value_(value), bits_(std::bit_width(static_cast<std::uint64_t>(std::abs(value)))) {}
    static ShortInteger unknown() { return {0, kMostBits + 1}; }

    friend bool is_known(const ShortInteger& a) { return a.bits_ <= kMostBits; }
    friend int sign_of(const ShortInteger& a) { return a.value_ > 0 ? 1 : (a.value_ < 0 ? -1 : 0); }
    mpz_class to_mpz() const {
        const UInt128 size =
            value_ < 0 ? -static_cast<UInt128>(value_) : static_cast<UInt128>(value_);
        mpz_class result(static_cast<unsigned long>(size >> 64));
        result <<= 64;
        result += static_cast<unsigned long>(size);
        return value_ < 0 ? mpz_class(-result) : result;
    }

    friend ShortInteger operator-(const ShortInteger& a) { return {-a.value_, a.bits_}; }
    friend ShortInteger operator+(const ShortInteger& a, const ShortInteger& b) {
        const int bits = (a.bits_ > b.bits_ ? a.bits_ : b.bits_) + 1;
        return bits <= kMostBits ? ShortInteger(a.value_ + b.value_, bits) : unknown();
    }
    friend ShortInteger operator-(const ShortInteger& a, const ShortInteger& b) { return a + -b; }
    friend ShortInteger operator*(const ShortInteger& a, const ShortInteger& b) {
        if (!is_known(a) || !is_known(b)) return unknown();
        if (a.value_ == 0 || b.value_ == 0) return {};
        const int bits = a.bits_ + b.bits_;
        return bits <= kMostBits ? ShortInteger(a.value_ * b.value_, bits) : unknown();
    }

private:
    static constexpr int kMostBits = 126;
    ShortInteger(Int128 value, int bits) : value_(value), bits_(bits) {}

    Int128 value_ = 0;
    int bits_ = 0;  ///< its size is below 2^bits_
};

/// Input differences as short integers, in the units of IntegerArithmetic.
class ShortArithmetic {
public:
    explicit ShortArithmetic(const PlanGeometry& geometry)
        : g_(geometry),
          plan_scale_(std::ldexp(1.0, -geometry.plan_exponent())),
          height_scale_(std::ldexp(1.0, -geometry.height_exponent())) {}

    ShortInteger dx(VertexId v, VertexId o) const {
        return difference(g_.point(v).x, g_.point(o).x, plan_scale_);
    }
    ShortInteger dy(VertexId v, VertexId o) const {
        return difference(g_.point(v).y, g_.point(o).y, plan_scale_);
    }
    ShortInteger dz(SpaceId s, SpaceId t) const {
        return difference(g_.space(s).z, g_.space(t).z, height_scale_);
    }
    ShortInteger plan(double value) const { return difference(value, 0.0, plan_scale_); }
    ShortInteger height(double value) const { return difference(value, 0.0, height_scale_); }

private:
    /// a - b in units of 1 / scale, a power of two that makes both of them whole.
    static ShortInteger difference(double a, double b, double scale) {
        constexpr double kMost = 0x1p61;
        const double p = a * scale, q = b * scale;
        if (!(std::abs(p) < kMost && std::abs(q) < kMost)) return ShortInteger::unknown();
        return ShortInteger(static_cast<std::int64_t>(p) - static_cast<std::int64_t>(q));
    }

    const PlanGeometry& g_;
    double plan_scale_, height_scale_;
};

}  // namespace realmodel::exact
