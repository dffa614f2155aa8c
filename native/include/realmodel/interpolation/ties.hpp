// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// Sheets of one surface over one planar mesh; they may have to stay equal at some nodes.
///
/// Sheets differ in their sides of faults. Where a fault's weight is 0 a correction is the same on
/// both its sides, where it is 1 those of the two sides have nothing to do with one another.
struct TiedSheets {
    std::span<const std::array<double, 2>> nodes;
    std::span<const std::array<std::int32_t, 3>> triangles;
    std::span<const double> heights;  ///< sheet after sheet; NaN: none there
    std::span<const double> sides;    ///< sheet after sheet, of each fault -1, +1 or 0 (both)
    std::span<const double> weights;  ///< fault after fault, at each node
};

/// What sheets must honor. A contact has two equal bounds, an inequality an infinite one.
struct TieData {
    std::span<const std::array<double, 2>> places;
    std::span<const double> lower, upper;
    std::span<const std::int32_t> sheets;  ///< to which sheet each counts
};

/// A correction of heights: sums of kernels of compact support, widest first, around centers.
struct TieTerms {
    std::vector<double> radii;                     ///< of the levels
    std::vector<std::array<double, 2>> positions;  ///< of the centers
    std::vector<double> sided;         ///< of each center its sides of faults times their weights
    std::vector<double> coefficients;  ///< level after level, of each center
};

struct Ties {
    TieTerms terms;
    /// Of each datum how far the sheet lies below it, or above it (negative); NaN where the sheet
    /// has no triangle.
    std::vector<double> before, after;
};

/// Finds a small smooth correction of heights at nodes with which sheets honor their data, also
/// within triangles.
///
/// The correction is that of the least norm in the space of a kernel (Wendland 1995, "Piecewise
/// polynomial, positive definite and compactly supported radial functions of minimal degree"),
/// under the heights in triangles that the data ask for; in levels, from kernels as wide as the
/// data are apart to ones as narrow as the nearest of them (Floater and Iske 1996, "Multistep
/// scattered data interpolation using compactly supported radial basis functions"). Inequalities
/// that do not hold are met as contacts are, those farthest from holding first. What others do not
/// leave room for is left as it is: inequalities before contacts.
///
/// Heights are only asked for at the corners of triangles with data.
/// @param tolerance  heights nearer than this to what is asked for are right
/// @throws InputError kind "not_finite" (items: the node), "bad_index" (items: the triangle)
/// @throws Cancelled
Ties tie(const TiedSheets& sheets, const TieData& data, double tolerance,
         const Execution& execution = {});

/// The heights of a sheet at nodes, corrected. Those of some nodes are the same bytes as among all.
/// @param sided  of each node the sheet's sides of faults times their weights there
std::vector<double> tied_heights(std::span<const double> heights,
                                 std::span<const std::array<double, 2>> nodes,
                                 std::span<const double> sided, const TieTerms& terms,
                                 const Execution& execution = {});

/// A sheet that was raised at the nodes of a planar mesh to least heights.
struct RaisedSheet {
    std::span<const std::array<double, 2>> nodes;
    std::span<const std::array<std::int32_t, 3>> triangles;
    std::span<const double> heights;
    std::span<const double> least;  ///< of the nodes; NaN: none
};

/// The heights of a raised sheet at its nodes with which it honors data within triangles, too, as
/// far as the least heights leave room; as they are where it does already.
///
/// Of how far the sheet is above the least heights at the corners of a triangle, each datum asks
/// that it lies between two planes. What is there is projected onto these, one after another, until
/// all hold (Kaczmarz 1937; Agmon 1954, "The relaxation method for linear inequalities", Canadian
/// Journal of Mathematics 6). What would lift a node by more than the range of the heights and
/// the data is left out.
/// @param margins    by how much bounds of the data are narrowed, for which there may be no room
/// @param tolerance  heights nearer than this to what is asked for are right
/// @throws InputError kind "not_finite" (items: the node), "bad_index" (items: the triangle)
/// @throws Cancelled
std::vector<double> raised_heights(const RaisedSheet& sheet, const TieData& data,
                                   std::span<const double> margins, double tolerance,
                                   const Execution& execution = {});

/// Data that a mesh cannot honor beside others.
struct CrowdedData {
    std::vector<std::int32_t> numbers;  ///< ascending
    std::vector<double> room;           ///< how far the nearest of the data that count is
};

/// Data of one sheet that nodes of a planar mesh cannot honor beside others, but with large
/// corrections: their places should become nodes themselves. Of inequalities only those count that
/// a gentle surface would not meet beside the nearest data.
/// @param sheet  its heights say where it is
/// @param least  of the square of a datum's row, a third in the middle of a triangle: where others
///               leave less, corrections would be large
/// @throws InputError kind "not_finite" (items: the node), "bad_index" (items: the triangle)
CrowdedData crowded_data(const TiedSheets& sheet, const TieData& data, double least);

}  // namespace realmodel::interpolation
