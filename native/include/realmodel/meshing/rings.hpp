// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// The rings of a region as points and straight segments between them: corners that repeat one
/// after another are one, corners at the same place (where rings touch) are one point.
struct RingGraph {
    std::vector<PlanPoint> points;                      ///< distinct, in order of appearance
    std::vector<std::array<std::int32_t, 2>> segments;  ///< ring after ring, in their direction
    std::vector<std::array<std::int64_t, 2>> origin;    ///< ring and corner where a segment starts
};

/// A region cut into triangles without new vertices: all triangles of the corners' convex hull, and
/// which of them belong to the region (inside an odd number of rings).
struct RingTriangulation {
    RingGraph graph;
    ConstrainedTriangulation triangulation;
    std::vector<bool> inside;
};

/// Checks outlines and holes and triangulates them. Rings go either way round, may repeat their
/// first corner at the end, and may touch others and themselves in points.
///
/// @throws InputError of kind
/// - "no_outline" (no ring),
/// - "not_finite" (items: ring, corner),
/// - "outline_degenerate" (fewer than three distinct corners or all in one line; items: ring),
/// - "outline_crosses" (items: ring and corner where the one edge starts, ring and corner of the
///   other; place),
/// - "outline_overlaps" (two edges share a stretch; items and place likewise).
RingTriangulation triangulate_region(std::span<const Ring> rings, Progress* progress = nullptr);

}  // namespace realmodel::meshing
