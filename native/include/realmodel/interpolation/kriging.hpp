// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "realmodel/interpolation/drift.hpp"
#include "realmodel/interpolation/neighborhood.hpp"
#include "realmodel/interpolation/sheets.hpp"
#include "realmodel/interpolation/variogram.hpp"

namespace realmodel::interpolation {

struct KrigingOptions {
    Neighborhood neighborhood;  ///< all points are factored once
    Drift drift = Drift::kConstant;
    Dips dips{};
    Sheets sheets{};  ///< with several, repeated points count once in each
};

struct Kriged {
    std::vector<double> z;         ///< of each node
    std::vector<double> variance;  ///< of its error, squared units of z, not negative
    std::int64_t alone =
        0;  ///< nodes with no point within the radius: there the nearest alone is used
};

/// Ordinary kriging (Matheron 1963; Chiles and Delfiner 2012, section 3.4), or with a drift
/// universal kriging (section 3.4 there; Matheron 1969).
///
/// A node on a point gets that point's value, with variance 0. Points whose value the nearer
/// ones determine (variance below 1e-10 of the sill) are left out of a system, so none is singular.
/// So is a term of the drift that the points do not distinguish from the terms before it: points in
/// one line have no slope across it, two points have a line, one point a constant.
/// With octants the points are chosen among the nearest 64 times as many.
/// With sheets it is cokriging: all points and dips count for the one that is asked for.
/// @param points  x, y, z; repeated points count once
/// @param nodes   x, y
/// @return        the same bytes for any number of threads
/// @throws InputError kind "no_points", "not_finite", "contradicting_points" (items: both points;
///         place), "variogram", "anisotropy", "option", "too_large" (says how much memory the
///         systems would take)
/// @throws Cancelled  within 0.2 s of Progress::cancel
Kriged krige(std::span<const std::array<double, 3>> points,
             std::span<const std::array<double, 2>> nodes, const Variogram& variogram,
             const KrigingOptions& options, const Execution& execution = {});

/// The same at each of the points, from all the others: what cross-validation compares with the
/// points' values. With all points as neighbors by the identities of Dubrule (1983,
/// "Cross validation of kriging in a unique neighborhood"), from one factor. Of a single point the
/// variance is infinite.
Kriged krige_left_out(std::span<const std::array<double, 3>> points, const Variogram& variogram,
                      const KrigingOptions& options, const Execution& execution = {});

}  // namespace realmodel::interpolation
