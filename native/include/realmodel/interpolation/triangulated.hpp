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

/// What a subset of some points has to know of all of them: those on the border of their hull
/// (hull_border) and the box around them; the box of which the subset has all points, and whether
/// these are all there are. The first of all is the first of the subset.
struct PointsAround {
    std::span<const std::array<double, 3>> border;
    std::array<double, 4> all, window;  ///< low x, low y, high x, high y
    bool is_whole = false;
};

/// certain: 1 for the nodes of which the subset's points give the value that all points give, to
/// the last bit; the others need a larger window.
struct SubsetValues {
    std::vector<double> z;
    std::vector<std::uint8_t> certain;
};

/// Values at nodes from a subset of some points, of which no two lie at one position and which keep
/// their order. A value is certain where the circles that it follows from lie in the window, but
/// for what of them is outside the hull of all: no other point can be in them.
SubsetValues linear_on_subset(std::span<const std::array<double, 3>> points,
                              std::span<const std::array<double, 2>> nodes,
                              const PointsAround& around, const Execution& execution = {});
SubsetValues natural_neighbors_of_subset(std::span<const std::array<double, 3>> points,
                                         std::span<const std::array<double, 2>> nodes,
                                         const PointsAround& around,
                                         const Execution& execution = {});

}  // namespace realmodel::interpolation
