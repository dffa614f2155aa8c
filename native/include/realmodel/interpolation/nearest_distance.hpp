// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

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
