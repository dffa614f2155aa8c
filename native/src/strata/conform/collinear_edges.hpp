// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "strata/conform/corner_offsets.hpp"
#include "strata/conform/matched_edges.hpp"
#include "strata/conform/plan_vertices.hpp"

namespace realmodel::strata {

/// The supporting lines of face edges, each with the edges on it. Lines that run through the same
/// points are one supporting line; it runs to rising x, or to rising y where x does not change.
struct CollinearEdges {
    Array<LineId> representative;  ///< the lowest of its lines; supporting lines have this order
    Array<std::uint32_t> edge_offsets;
    Array<LineEdge> edges;
    std::vector<PassedVertices> passed;  ///< by the edges of so many lines each
    std::vector<MatchedEdges> matched;   ///< of the lines that are left out above

    std::size_t size() const { return representative.size(); }
};
/// @param cell_is_thick  if given, lines on which all edges match (matched_edges.hpp) are left
/// out:
///     their walls are planned, and their edges pass only what others need
CollinearEdges find_collinear_edges(const exact::PlanArrangement& geometry, const FaceList& faces,
                                    const PlanVertices& plan_vertices,
                                    const std::vector<ExtraPoint>& extra,
                                    const Array<std::uint8_t>* cell_is_thick,
                                    const Execution& execution);

}  // namespace realmodel::strata
