// SPDX-License-Identifier: GPL-3.0-or-later
// The border of a region, and the lines inside, cut into pieces as long as edges should be.
#pragma once

#include "meshing/edge_cutting.hpp"
#include "meshing/region_graph.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// First the points of the graph as they are, then points added on its edges, each rounded once.
/// Pieces cross nowhere: a point is left out, and used by no piece, where rounding would put it
/// beyond another edge.
struct BorderPieces {
    std::vector<PlanPoint> points;
    std::vector<Segment> border;  ///< the region on their left
    std::vector<Segment> inner;
    std::vector<CutEdge> edges;   ///< of the graph, border and inner, with what cuts them
    std::vector<Segment> locked;  ///< of the border: too close to others outside of the region to
                                  ///< be cut again; sorted
};

/// Cuts every edge into pieces that are equal as measured by the length wanted where they are, at
/// most 1.4 of it. Around a corner sharper than 60 degrees all edges are first cut at one distance
/// from it, so that the triangle at the tip has two equal edges (Ruppert 1995, section 7, "corner
/// lopping" by concentric circles). `finest`: pieces half as long will not be cut again.
BorderPieces cut_border(const RegionGraph& graph, SizeField& size, double finest,
                        const Check& check);

/// Cuts every edge where it crosses the lines of a grid of squares, but for cuts nearer than
/// `closest` (sides of a square) to an end or to the cut before.
BorderPieces cut_border_by_grid(const RegionGraph& graph, const PlanPoint& origin, double side,
                                double closest, double finest, const Check& check);

/// About how many pieces cut_border makes for one length everywhere; cheap, for estimates.
double estimate_pieces(const RegionGraph& graph, double edge_length);

}  // namespace realmodel::meshing
