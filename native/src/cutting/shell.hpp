// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "base/disjoint_sets.hpp"
#include "cutting/pieces.hpp"

namespace realmodel::cutting {

/// Takes a polygon of a shell, which is named by its set. It turns counter-clockwise seen from
/// outside (sign 1), or clockwise (-1).
using VisitShellPolygon =
    std::function<void(std::int32_t shell, std::span<const Position> corners, int sign)>;

/// The wall of a hollow bounds the part around it, and what rounding turned inside out goes with
/// the part beside it. Joins the set of each shell without a positive volume with that of a larger
/// one: the innermost that contains it, which is decided exactly; where none does, the smallest
/// whose box contains its box, or else the smallest.
/// @param each_polygon  calls its argument for all polygons of the shells of a cell on one side of
///                      the cutter, each time in the same order
void join_hollows(const std::function<void(const VisitShellPolygon&)>& each_polygon,
                  DisjointSets& sets);

}  // namespace realmodel::cutting
