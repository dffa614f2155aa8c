// SPDX-License-Identifier: GPL-3.0-or-later
// The border of a region cut into pieces of about the edge length. Private.
#pragma once

#include "meshing/constrained_delaunay.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

/// The region's border: first the corners of the rings as they are, then points added on the edges,
/// each rounded once; pieces run with the region on their left.
struct BorderPieces {
    std::vector<PlanPoint> points;
    std::vector<Segment> pieces;
};

/// Cuts every edge of the border into equal pieces of at most 1.4 edge lengths. Around a corner
/// sharper than 60 degrees all edges are first cut at one distance from it, so that the triangle at
/// the tip has two equal sides (Ruppert 1995, section 7, "corner lopping" by concentric circles).
BorderPieces cut_border(const RingTriangulation& region, double edge_length);

/// About how many pieces cut_border makes; cheap, for estimates.
double estimate_pieces(const RingTriangulation& region, double edge_length);

}  // namespace realmodel::meshing
