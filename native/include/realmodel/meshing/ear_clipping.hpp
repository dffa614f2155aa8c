// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// Divides a polygon, an outline and holes in it, into triangles of its corners, and swaps edges
/// until they are constrained Delaunay (Mei 2014, section 2.2.3): holes are joined to the outline
/// by bridges (Eberly 2002, "Triangulation by ear clipping"), ears are cut off (Meisters 1975), at
/// first those whose circles are empty nearby, and diagonals are flipped (Lawson 1977). Decisions
/// are exact.
///
/// Returns corner numbers, counter-clockwise, counting through the rings; corners at one place keep
/// their own numbers. All corners are used but those that repeat the one before; corners in one
/// line stay corners. Rings go either way round. Holes may touch the outline, one another and
/// themselves in points. Whether rings cross is not looked for (triangulate_region does): triangles
/// may overlap then.
///
/// Every triangle has positive area, so together they cover each place as often as the rings wind
/// round it: once. Where ears of positive area run out (a hole that touches an edge between its
/// corners), triangulate_region does the work.
///
/// @throws InputError as that does; Cancelled. `progress` may be null.
std::vector<std::array<std::int32_t, 3>> triangulate_polygon(std::span<const Ring> rings,
                                                             Progress* progress = nullptr);

}  // namespace realmodel::meshing
