// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "exact/int126.hpp"

namespace realmodel::exact {

/// A whole number of up to 1536 bits that needs no memory of its own; one that might have more is
/// not known. Wide enough for signs of determinants of places where lines pass through planes, far
/// from the limits of doubles.
class FixedInteger {
public:
    FixedInteger() = default;
    FixedInteger(const FixedInteger& other) { *this = other; }
    FixedInteger& operator=(const FixedInteger& other) {
        size_ = other.size_;
        negative_ = other.negative_;
        for (int i = 0; i < size_; ++i)
            limbs_[at(i)] = other.limbs_[at(i)];
        return *this;
    }
    static FixedInteger unknown() {
        FixedInteger result;
        result.size_ = kUnknown;
        return result;
    }
    /// A double in units of 2^unit, of which it must be a whole multiple.
    static FixedInteger of(double value, int unit) {
        FixedInteger result;
        if (value == 0) return result;
        int exponent = 0;
        const double fraction = std::frexp(std::abs(value), &exponent);
        auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
        int shift = exponent - 53 - unit;
        if (shift < 0) {  // what it loses are zeros
            mantissa >>= -shift;
            shift = 0;
        }
        if (shift >= 64 * (kLimbs - 1)) return unknown();
        result.negative_ = value < 0;
        result.size_ = shift / 64 + 2;
        for (int i = 0; i < result.size_; ++i)
            result.limbs_[at(i)] = 0;
        const UInt128 shifted = static_cast<UInt128>(mantissa) << (shift % 64);
        result.limbs_[at(shift / 64)] = static_cast<std::uint64_t>(shifted);
        result.limbs_[at(shift / 64 + 1)] = static_cast<std::uint64_t>(shifted >> 64);
        result.trim();
        return result;
    }

    friend bool is_known(const FixedInteger& a) { return a.size_ != kUnknown; }
    friend int sign_of(const FixedInteger& a) { return a.size_ == 0 ? 0 : (a.negative_ ? -1 : 1); }

    friend FixedInteger operator-(FixedInteger a) {
        a.negative_ = !a.negative_;
        return a;
    }
    friend FixedInteger operator+(const FixedInteger& a, const FixedInteger& b) {
        if (!is_known(a) || !is_known(b)) return unknown();
        if (a.negative_ == b.negative_) return sum(a, b);
        const int order = compare_sizes(a, b);
        if (order == 0) return {};
        return order > 0 ? difference(a, b) : difference(b, a);
    }
    friend FixedInteger operator-(const FixedInteger& a, const FixedInteger& b) { return a + -b; }
    friend FixedInteger operator*(const FixedInteger& a, const FixedInteger& b) {
        if (!is_known(a) || !is_known(b)) return unknown();
        if (a.size_ == 0 || b.size_ == 0) return {};
        if (a.size_ + b.size_ > kLimbs) return unknown();
        FixedInteger result;
        result.size_ = a.size_ + b.size_;
        result.negative_ = a.negative_ != b.negative_;
        for (int i = 0; i < result.size_; ++i)
            result.limbs_[at(i)] = 0;
        for (int i = 0; i < a.size_; ++i) {
            std::uint64_t carry = 0;
            for (int j = 0; j < b.size_; ++j) {
                const UInt128 product = static_cast<UInt128>(a.limbs_[at(i)]) * b.limbs_[at(j)] +
                                        result.limbs_[at(i + j)] + carry;
                result.limbs_[at(i + j)] = static_cast<std::uint64_t>(product);
                carry = static_cast<std::uint64_t>(product >> 64);
            }
            result.limbs_[at(i + b.size_)] = carry;
        }
        result.trim();
        return result;
    }

private:
    static constexpr int kLimbs = 24, kUnknown = -1;
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }

    void trim() {
        while (size_ > 0 && limbs_[at(size_ - 1)] == 0)
            --size_;
    }
    static int compare_sizes(const FixedInteger& a, const FixedInteger& b) {
        if (a.size_ != b.size_) return a.size_ > b.size_ ? 1 : -1;
        for (int i = a.size_ - 1; i >= 0; --i) {
            if (a.limbs_[at(i)] != b.limbs_[at(i)])
                return a.limbs_[at(i)] > b.limbs_[at(i)] ? 1 : -1;
        }
        return 0;
    }
    /// The sum of two of one sign.
    static FixedInteger sum(const FixedInteger& a, const FixedInteger& b) {
        const FixedInteger &more = a.size_ >= b.size_ ? a : b, &less = a.size_ >= b.size_ ? b : a;
        FixedInteger result;
        result.negative_ = a.negative_;
        result.size_ = more.size_;
        std::uint64_t carry = 0;
        for (int i = 0; i < more.size_; ++i) {
            const UInt128 digit = static_cast<UInt128>(more.limbs_[at(i)]) +
                                  (i < less.size_ ? less.limbs_[at(i)] : 0) + carry;
            result.limbs_[at(i)] = static_cast<std::uint64_t>(digit);
            carry = static_cast<std::uint64_t>(digit >> 64);
        }
        if (carry == 0) return result;
        if (result.size_ == kLimbs) return unknown();
        result.limbs_[at(result.size_++)] = carry;
        return result;
    }
    /// The sum of two of different signs, the first of which is farther from zero.
    static FixedInteger difference(const FixedInteger& a, const FixedInteger& b) {
        FixedInteger result;
        result.negative_ = a.negative_;
        result.size_ = a.size_;
        std::uint64_t borrow = 0;
        for (int i = 0; i < a.size_; ++i) {
            const std::uint64_t from = a.limbs_[at(i)], off = i < b.size_ ? b.limbs_[at(i)] : 0;
            result.limbs_[at(i)] = from - off - borrow;
            borrow = from < off || (from == off && borrow != 0) ? 1 : 0;
        }
        result.trim();
        return result;
    }

    std::array<std::uint64_t, kLimbs> limbs_;  ///< the least first; `size_` of them are set
    int size_ = 0;
    bool negative_ = false;
};

}  // namespace realmodel::exact
