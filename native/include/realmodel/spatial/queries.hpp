// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::spatial {

/// Of each position the nearest items, nearest first, the first of equally near ones, and how far
/// they are; -1 and infinite where there are fewer.
struct Nearest {
    std::vector<std::int32_t> number;
    std::vector<double> distance;
};

/// The `count` nearest of points, in plan. The same bytes for any number of threads.
/// @throws InputError kind "no_points", "not_finite", "too_large"
/// @throws Cancelled
Nearest nearest_points(std::span<const std::array<double, 2>> points,
                       std::span<const std::array<double, 2>> positions, std::size_t count = 1,
                       const Execution& execution = {});

using SpaceTriangle = std::array<std::array<double, 3>, 3>;

/// The nearest of triangles among those that are nearer than `reach` to a position.
/// Distances are true up to rounding of what is near the position: long triangles have their plane
/// from their shorter edges, taken from their nearest corner.
/// @throws Cancelled
Nearest nearest_triangles(std::span<const SpaceTriangle> triangles,
                          std::span<const std::array<double, 3>> positions, double reach,
                          const Execution& execution = {});

/// Of each position in plan the greatest height at which the nearest of triangles is `away` from
/// it: the upper envelope of spheres, tubes and prisms around their corners, edges and insides.
/// The triangles are those of a sheet that goes on far enough around the positions; `z` are its
/// heights there. At it no triangle is nearer, up to rounding. NaN where the sheet has no height.
/// @throws InputError kind "bad_index" where there are not as many of each, "too_large"
/// @throws Cancelled
std::vector<double> heights_at_distance(std::span<const SpaceTriangle> triangles,
                                        std::span<const std::array<double, 2>> positions,
                                        std::span<const double> z, std::span<const double> away,
                                        const Execution& execution = {});

/// Two opposite corners, the lower one first.
using CornersOfBox = std::array<std::array<double, 3>, 2>;

/// The pairs of boxes, one of each list, that have a point in common: by the boxes of the shorter
/// list, those of each by the least x of the other box.
std::vector<std::array<std::int64_t, 2>> meeting_boxes(std::span<const CornersOfBox> first,
                                                       std::span<const CornersOfBox> second);

/// Which way paths in plan from a over b to c turn: 1 left, -1 right, 0 straight on. Exact.
/// @throws InputError kind "bad_index" where there are not as many of each
std::vector<std::int8_t> turns(std::span<const std::array<double, 2>> a,
                               std::span<const std::array<double, 2>> b,
                               std::span<const std::array<double, 2>> c);

}  // namespace realmodel::spatial
