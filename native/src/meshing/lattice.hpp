// SPDX-License-Identifier: GPL-3.0-or-later
// Points of an equilateral lattice inside a region. Private.
#pragma once

#include "meshing/border_pieces.hpp"

namespace realmodel::meshing {

/// The corners of a tiling by equilateral triangles of side `edge_length` that lie in the region
/// and at least `clearance` from its border; row after row. Time and memory grow with the points
/// made and the pieces, not with the bounding box.
std::vector<PlanPoint> lattice_inside(const BorderPieces& border, double edge_length,
                                      double clearance, const Check& check);

}  // namespace realmodel::meshing
