// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// A ring of a region, and what it is said to be.
struct RegionRing {
    Ring corners;
    std::int32_t polygon;  ///< rings of one polygon have the same number
    bool hole;             ///< said to lie inside the polygon's ring that is none
};

/// Checks the rings of a region that may have several polygons, and gives them as rings that touch
/// in points at most (what triangulate_region takes); they count even-odd.
///
/// Polygons may share borders: those vanish, so that neighboring polygons make one region. Where
/// none do, the rings come back as they are. Islands may lie in holes, whatever they are said to
/// be.
///
/// @throws InputError as triangulate_region does - two edges of one polygon may not share a stretch
/// - and of kind
/// - "hole_outside" (items: the ring, a corner of it; place),
/// - "no_area" (the polygons take each other away).
std::vector<Ring> checked_region(std::span<const RegionRing> rings, Progress* progress = nullptr);

}  // namespace realmodel::meshing
