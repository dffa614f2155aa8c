// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"

namespace realmodel::interpolation {

/// An inner edge with the two triangles at it. It adds (g . z)^2, z the heights of the four nodes,
/// to the roughness of the surface: how its slope changes across the edge. Of a linear function g .
/// z is 0.
struct Hinge {
    std::array<std::int32_t, 4> nodes;
    std::array<double, 4> g;
    Position middle;                ///< of the edge
    std::array<double, 3> bending;  ///< g . z for surfaces with the second derivatives xx, xy, yy
};

/// The hinges of a mesh; triangles may have either orientation, those without area have none. A
/// triangle with no hinge at all has one of stiffness 0, so that each triangle's corners share a
/// row.
std::vector<Hinge> hinges(std::span<const Position> nodes,
                          std::span<const std::array<std::int32_t, 3>> triangles);

}  // namespace realmodel::interpolation
