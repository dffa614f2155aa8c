// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace realmodel::exact {

// Signs of determinants in floating point, with a bound on the error. Every filter may say that it
// does not know; none is ever wrong. With e = 2^-53, half a unit in the last place of 1:
//
// Rounding of the arithmetic. J. R. Shewchuk ("Adaptive precision floating-point arithmetic and
// fast robust geometric predicates", 1997) bounds the error of the determinant of two differences
// of points by (3 + 16 e) e times the sum of the sizes of its products, and that of three by
// (7 + 56 e) e times the same sum. The constants below are 8 e and 32 e: the rest covers the
// rounding of that sum and of the bound.
//
// Coordinates that are known to within r only. A difference of two is then off by off = 2 r at
// most, a product of two such differences of size L or less by 2 off (L + off), a product of three
// by 3 off (L + off)^2. There are two of the former and six of the latter: 4 off (L + off) and
// 18 off (L + off)^2. The constants are 8 and 24 (which covers the rounding of the bound).
//
// Underflow. A product may lose 2^-1075. In a determinant of three differences the six inner
// products lose as much and are then multiplied by L.
inline constexpr double kRounding2d = 0x1p-50, kRounding3d = 0x1p-48;
inline constexpr double kInexact2d = 8, kInexact3d = 24;
inline constexpr double kUnderflow = 1e-280, kInnerUnderflow = 0x1p-1070;

/// `off` where coordinates up to this size are the doubles nearest to the true ones: each is off by
/// 2^-53 of it or half of the least double, a difference by 2^-52 of it, which is doubled here.
inline double inexactness_of_rounding(double largest) {
    return 0x1p-51 * largest + 0x1p-1070;
}

/// Which way a, b, c turn in the plane: 1 left, -1 right, nothing where it cannot tell.
/// @param off  how far the difference of two coordinates may be from the true one, beside the
///             rounding of the difference itself
inline std::optional<int> orient2d_filter(const std::array<double, 2>& a,
                                          const std::array<double, 2>& b,
                                          const std::array<double, 2>& c, double off = 0) {
    const double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - a[0], vy = c[1] - a[1];
    const double left = ux * vy, right = uy * vx;
    double error = kRounding2d * (std::abs(left) + std::abs(right)) + kUnderflow;
    if (off > 0) {
        const double largest = std::max({std::abs(ux), std::abs(uy), std::abs(vx), std::abs(vy)});
        error += kInexact2d * off * (largest + off);
    }
    if (left - right > error) return 1;
    if (left - right < -error) return -1;
    return std::nullopt;
}

/// The plane of a, b, c, to ask for the sides of several points.
class SideFilter {
public:
    using Position = std::array<double, 3>;

    SideFilter(const Position& a, const Position& b, const Position& c) : a_(a) {
        std::array<double, 3> u, v;
        for (std::size_t k = 0; k < 3; ++k) {
            u[k] = b[k] - a[k];
            v[k] = c[k] - a[k];
            largest_ = std::max({largest_, std::abs(u[k]), std::abs(v[k])});
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
            const double left = u[l] * v[m], right = u[m] * v[l];
            normal_[k] = left - right;
            sizes_[k] = std::abs(left) + std::abs(right);
        }
    }

    /// Which side of the plane has d: 1 where a, b, c turn counter-clockwise seen from d, -1 the
    /// other, nothing where it cannot tell. `off` as in orient2d_filter.
    std::optional<int> operator()(const Position& d, double off = 0) const {
        double value = 0, size = 0, largest = largest_;
        for (std::size_t k = 0; k < 3; ++k) {
            const double w = d[k] - a_[k];
            value += normal_[k] * w;
            size += sizes_[k] * std::abs(w);
            largest = std::max(largest, std::abs(w));
        }
        const double reach = largest + off;
        const double error = kRounding3d * size + kInexact3d * off * reach * reach +
                             kInnerUnderflow * largest + kUnderflow;
        if (value > error) return 1;
        if (value < -error) return -1;
        return std::nullopt;
    }

private:
    Position a_, normal_, sizes_;
    double largest_ = 0;
};

/// The same for one point.
inline std::optional<int> orient3d_filter(const std::array<double, 3>& a,
                                          const std::array<double, 3>& b,
                                          const std::array<double, 3>& c,
                                          const std::array<double, 3>& d, double off = 0) {
    return SideFilter(a, b, c)(d, off);
}

}  // namespace realmodel::exact
