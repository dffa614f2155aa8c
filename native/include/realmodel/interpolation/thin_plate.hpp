// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "realmodel/interpolation/neighborhood.hpp"

namespace realmodel::interpolation {

struct ThinPlateOptions {
    /// Added to the diagonal where distances are measured in the points' mean spacing; 0: points
    /// are met exactly.
    double smoothing = 0;
    Neighborhood neighborhood;  ///< a spline of all points is solved once
    /// The unit of distances; 0: the points' mean spacing. A subset of the points gives heights of
    /// the whole with that of the whole.
    double spacing = 0;
    Dips dips{};
};

/// The side of a square as large as each point's share of the box of all; 1 where this is none.
/// @param are_apart  no two points lie at one position, and all are finite: nothing is looked for
/// @throws InputError as thin_plate for points
double mean_spacing(std::span<const std::array<double, 3>> points, bool are_apart = false);

/// Thin plate splines (Duchon 1977; Wahba 1990, "Spline models for observational data",
/// section 2.4): sum w_i r_i^2 log r_i + a + b x + c y, the surface that bends least through the
/// points or, with smoothing, near them. A node on a point gets its value where there is no
/// smoothing. Points in one line have no slope across it.
/// Dips are met as closely as the ends of their baselines say, whatever the smoothing: differences
/// of heights are functionals like these (Wahba 1990, section 1.3).
///
/// @param points  x, y, z; repeated points count once
/// @param nodes   x, y
/// @return        z of each node; the same for any number of threads
/// @throws InputError kind "no_points", "not_finite", "contradicting_points", "option", "too_large"
/// @throws Cancelled
std::vector<double> thin_plate(std::span<const std::array<double, 3>> points,
                               std::span<const std::array<double, 2>> nodes,
                               const ThinPlateOptions& options, const Execution& execution = {});

}  // namespace realmodel::interpolation
