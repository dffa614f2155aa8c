// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Every constant that a filter of plan geometry depends on. README.md derives each of them, under
// its name; those of space are in sign_filters.hpp.
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

}  // namespace realmodel::exact
