// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/interpolation/neighborhood.hpp"

namespace realmodel::interpolation {

struct InverseDistanceOptions {
    double power = 2;  ///< positive
    Neighborhood neighborhood;
};

/// Means of the values of the nearest points weighted by distance^-power (Shepard 1968). A node on
/// a point gets that point's value.
///
/// @param points  x, y, z
/// @param nodes   x, y
/// @return        z of each node; the same for any number of threads
/// @throws InputError kind "no_points", "not_finite", "contradicting_points", "too_large", "option"
/// @throws Cancelled
std::vector<double> inverse_distance(std::span<const std::array<double, 3>> points,
                                     std::span<const std::array<double, 2>> nodes,
                                     const InverseDistanceOptions& options,
                                     const Execution& execution = {});

/// The same at each of the points, from all the others; a single point gives its own value.
std::vector<double> inverse_distance_left_out(std::span<const std::array<double, 3>> points,
                                              const InverseDistanceOptions& options,
                                              const Execution& execution = {});

/// How far the nearest point is from each node, in plan.
/// @param points  x, y, z; at least one
/// @param nodes   x, y
/// @return        the same bytes for any number of threads
/// @throws InputError kind "no_points", "not_finite", "too_large"
/// @throws Cancelled
std::vector<double> nearest_distances(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes,
                                      const Execution& execution = {});

}  // namespace realmodel::interpolation
