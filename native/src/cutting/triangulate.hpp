// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "polygons.hpp"

namespace realmodel::cutting {

/// A corner of a loop: its node, and where it lies in the view.
struct LoopCorner {
    NodeId node;
    PlanePosition at;
};
using Loop = std::vector<LoopCorner>;

/// Divides the region that loops bound (outlines counter-clockwise, holes clockwise; a hole may be
/// a slit of two corners) into triangles without new nodes, by cutting off ears (G. H. Meisters
/// 1975), with holes joined to their outline by bridges (D. Eberly, "Triangulation by ear
/// clipping", 2002) and ears tested against what is near along a space-filling curve.
///
/// Each edge of each loop belongs to exactly one triangle, and every other edge to two, whatever
/// the loops look like: where rounding has made them cross, triangles may overlap by as much, but
/// nothing gapes. `rounding` is the distance below which a triangle counts as thin: others are
/// preferred.
void triangulate(std::span<const Loop> loops, double rounding,
                 std::vector<std::array<LoopCorner, 3>>& triangles);

/// The same region in convex polygons, up to `rounding`: triangles merged wherever that leaves a
/// convex one (S. Hertel and K. Mehlhorn 1983). `slits` are edges that must stay, as (lesser,
/// greater) node, sorted.
void divide_convex(std::span<const Loop> loops, double rounding,
                   std::span<const std::array<NodeId, 2>> slits, Polygons& result);

/// Whether a loop turns left everywhere, up to `rounding`, and passes no node twice.
bool is_convex(const Loop& loop, double rounding);

}  // namespace realmodel::cutting
