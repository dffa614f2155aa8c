// SPDX-License-Identifier: GPL-3.0-or-later
// The border of a region, and the lines inside, cut into pieces as long as edges should be.
//
#pragma once

#include "meshing/check.hpp"
#include "meshing/region_graph.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// First the points of the graph as they are, then points added on its edges, each rounded once.
struct BorderPieces {
    std::vector<PlanPoint> points;
    std::vector<Segment> border;  ///< the region on their left
    std::vector<Segment> inner;
};

/// Cuts every edge into pieces that are equal as measured by the length wanted where they lie, at
/// most 1.4 of it. Around a corner sharper than 60 degrees all edges are first cut at one distance
/// from it, so that the triangle at the tip has two equal sides (Ruppert 1995, section 7, "corner
/// lopping" by concentric circles).
BorderPieces cut_border(const RegionGraph& graph, const SizeField& size, const Check& check);

/// Cuts every edge where it crosses the lines of a grid of squares, but for cuts nearer than
/// `closest` (sides of a square) to an end or to the cut before.
BorderPieces cut_border_by_grid(const RegionGraph& graph, const PlanPoint& origin, double side,
                                double closest, const Check& check);

/// About how many pieces cut_border makes for one length everywhere; cheap, for estimates.
double estimate_pieces(const RegionGraph& graph, double edge_length);

}  // namespace realmodel::meshing
