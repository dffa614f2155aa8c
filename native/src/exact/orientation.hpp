// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

// Every constant that a filter depends on, and which side of lines and planes points with double
// coordinates are. README.md derives the constants of plan geometry, each under its name.
namespace realmodel::exact {

/// Half of the distance from 1 to the next double: what one operation of doubles errs by.
inline constexpr double kUnitRoundoff = 0x1p-53;
/// Twice that: as much for one operation as for what its bound loses to products of bounds.
inline constexpr double kEpsilon = 0x1p-52;
/// A bound that was itself computed in doubles, times this, is one in spite of its own rounding.
inline constexpr double kBoundSlack = 1 + 0x1p-40;
/// More than underflow takes from a sum of a few products.
inline constexpr double kTermUnderflow = 1e-290;
/// The same of a coordinate.
inline constexpr double kCoordinateUnderflow = 1e-300;

/// Epsilons by which the value a x + b y + c of a LineFilter errs, of the sum of its terms' sizes.
inline constexpr double kLineValue = 4 * kEpsilon;
/// Of a 2 x 2 determinant of differences of doubles, of the sum of its products' sizes.
inline constexpr double kDeterminant = 4 * kEpsilon;
/// Of the height of a plane at another plane's corner, of the sum of its terms' sizes.
inline constexpr double kPlaneHeight = 4 * kEpsilon;

/// Error of one sum, product or quotient of double-double numbers, and what underflow takes.
inline constexpr double kDoubleDoubleUnit = 0x1p-98;
inline constexpr double kDoubleDoubleUnderflow = 1e-280;

/// Error of one operation with 64 bits of mantissa, with what bounds in doubles lose; and what
/// these lose where doubles underflow.
inline constexpr double kExtendedUnit = 0x1.01p-64;
inline constexpr double kExtendedUnderflow = 0x1p-1000;
/// What a number with more bits than a double loses, at most, when it becomes one; generously.
inline constexpr double kNarrowing = 0x1p-50;

// Margins: not bounds of anything that was computed, but distances beside which all rounding is
// small.

/// So many times its error bound decides a value that rounding must not come near.
inline constexpr double kFarTimes = 64;
/// What rounding heights is small beside, of the largest height.
inline constexpr double kClearHeight = 0x1p-40;
/// What rounding positions is small beside, in errors of a position.
inline constexpr double kClearPositions = 0x1p24;

/// Which way the path a -> b -> c turns in the plane: 1 left, -1 right, 0 straight on. Exact for
/// any finite coordinates.
int orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b,
             const std::array<double, 2>& c);

/// Whether three points of space lie in one line, exactly.
bool in_one_line(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c);

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
