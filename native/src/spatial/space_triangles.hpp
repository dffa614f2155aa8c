// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "base/vectors.hpp"
#include "realmodel/spatial/queries.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::spatial {

/// How far a position is from a triangle. Over the triangle it is known to nearly all digits,
/// however narrow the triangle is; beside it to the rounding of coordinates.
double triangle_distance(const Vec3& p, const SpaceTriangle& triangle);

/// Distances from boxes are rounded: what is so little farther may yet be as near.
constexpr double kRoundedDistance = 1 + 1e-9;

/// @throws InputError kind "too_large"
std::vector<Box> boxes_of(std::span<const SpaceTriangle> triangles);

}  // namespace realmodel::spatial
