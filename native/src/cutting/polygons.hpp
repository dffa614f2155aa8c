// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "arrangement/triangulate.hpp"

namespace realmodel::cutting {

using arrangement::CornerTurns;
using arrangement::divide_convex;
using arrangement::Loop;
using arrangement::LoopCorner;
using arrangement::NodeId;
using arrangement::PlanePosition;
using arrangement::Polygons;
using arrangement::Position;
using arrangement::rounding_of;
using arrangement::triangulate;
using arrangement::triangulate_beside;
using arrangement::View;

/// Sides of a cutter: above it or outside of it, on it, below it or inside.
inline constexpr std::int8_t kAbove = 1, kOn = 0, kBelow = -1;

}  // namespace realmodel::cutting
