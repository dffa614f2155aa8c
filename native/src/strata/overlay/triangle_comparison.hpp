// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "spatial/plan_tiles.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Plan box and heights of a triangle.
struct TriangleBounds {
    PlanBox box;
    double low, high;
};
TriangleBounds bounds_of(const exact::PlanArrangement& geometry, PlaneId plane);

/// What a pair of triangles is to each other where they share a position in plan, for certain.
enum class Comparison { kBelow, kAbove, kApart, kUnclear };

/// Compares triangle `lower` with triangle `upper`, of which at least what lies in two boxes
/// counts: their difference over the common part of the boxes decides, or over either triangle.
Comparison compare_over(const exact::PlanArrangement& geometry, PlaneId lower, PlaneId upper,
                        const PlanBox& lower_box, const PlanBox& upper_box, double margin);

/// Whether two triangles share no position in plan, not even a corner, for certain.
bool are_apart(const exact::PlanArrangement& geometry, PlaneId a, PlaneId b);

/// The middle of some corners, as rounding leaves it.
template <class Corners, class PointOf>
std::array<double, 2> middle_of(const Corners& corners, const PointOf& point_of) {
    std::array<double, 2> middle{0, 0};
    const double share = 1.0 / static_cast<double>(corners.size());
    for (const auto& corner : corners) {
        const exact::Point& p = point_of(corner);
        middle[0] += p.x * share;
        middle[1] += p.y * share;
    }
    return middle;
}
std::array<double, 2> middle_of(const exact::PlanArrangement& geometry, PlaneId plane);

/// On which side of a triangle's border a position lies that rounding may have moved: 1 inside for
/// certain, -1 outside for certain, 0 near the border.
int side_of_border(const exact::PlanArrangement& geometry, const PlanTriangle& triangle,
                   const std::array<double, 2>& position);

/// Plan positions of a triangle's corners.
inline std::array<std::array<double, 2>, 3> corners_of(const exact::PlanArrangement& geometry,
                                                       const PlanTriangle& triangle) {
    std::array<std::array<double, 2>, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
        p[i] = {geometry.point(triangle[i]).x, geometry.point(triangle[i]).y};
    return p;
}

}  // namespace realmodel::strata
