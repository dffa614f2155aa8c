// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// Linear interpolation on the Delaunay triangulation of the points in plan. A node outside their
/// convex hull gets the value at the nearest position of the hull's border.
///
/// @param points  x, y, z; repeated points count once
/// @param nodes   x, y
/// @param threads 0: as many as there are; the same bytes for any number
/// @return        z of each node; a node on a point gets its value exactly
/// @throws InputError kind "no_points", "not_finite", "contradicting_points", "too_large"
/// @throws Cancelled
std::vector<double> linear_on_triangulation(std::span<const std::array<double, 3>> points,
                                            std::span<const std::array<double, 2>> nodes,
                                            const Execution& execution = {});

/// Natural neighbor interpolation: the mean of the points whose Voronoi cells a node would take
/// area from, weighted by that area (Sibson 1981, "A brief description of natural neighbor
/// interpolation"). Smooth but at the points; linear functions come out exactly. Outside the hull,
/// and where a node is so near its border that rounding spoils the areas, as
/// linear_on_triangulation. The same arguments, result and errors.
std::vector<double> natural_neighbors(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes,
                                      const Execution& execution = {});

}  // namespace realmodel::interpolation
