// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "cutting/cutter_surface.hpp"

namespace realmodel::structures {

/// What continues a fault around its border, however ragged that is: triangles between the border
/// and a rectangle in its mean plane, then that plane. So the continuation crosses neither itself
/// nor the fault, and it is the same however far it reaches. Holes of the fault are filled.
///
/// Nothing where the border crosses itself or turns over seen at right angles to that plane.
/// @param border   the edges that one triangle has, as that triangle runs
/// @param lengths  how far beyond the rectangle its parts reach, ascending
std::optional<std::vector<std::array<cutting::Position, 3>>> continued_in_mean_plane(
    const cutting::CutterSurface& fault, std::span<const std::array<cutting::NodeId, 2>> border,
    std::span<const double> lengths);

}  // namespace realmodel::structures
