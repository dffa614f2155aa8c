// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "base/disjoint_sets.hpp"
#include "cutting/pieces.hpp"

namespace realmodel::cutting {

/// Takes a polygon around a part. It turns counter-clockwise seen from outside (sign 1), or
/// clockwise (-1).
using VisitShellPolygon = std::function<void(std::span<const Position> corners, int sign)>;

/// The wall of a hollow bounds the part around it, and what rounding turned inside out goes with
/// the part beside it. Joins the set of each shell without a positive volume with that of a larger
/// one: the innermost that contains it, which is decided exactly; where none does, the smallest
/// whose box contains its box, or else the smallest.
/// @param items        what bounds the parts of a cell on one side of the cutter; each set of them
///                     is a shell
/// @param polygons_of  polygons_of(item, visit) calls visit for the item's polygons
void join_hollows(
    std::span<const std::int32_t> items, DisjointSets& sets,
    const std::function<void(std::int32_t item, const VisitShellPolygon&)>& polygons_of);

}  // namespace realmodel::cutting
