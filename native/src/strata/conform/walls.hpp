// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "strata/conform/conformed_faces.hpp"
#include "strata/conform/wall_joining.hpp"
#include "strata/overlay/border_edges.hpp"

namespace realmodel::strata {

/// A stretch of vertical face between two neighboring plan vertices of a line, with nodes of
/// different blocks on its sides.
struct WallStretch {
    std::int32_t line, interval;
    std::array<std::int32_t, 2> lower, upper;  ///< vertices at the first plan vertex and the second
    std::int32_t left, right;                  ///< nodes, or kOutsideCell
};

/// What is asked besides where nodes become the cells of blocks.
struct BlockLines {
    const Array<std::int32_t>& node_block;
    const PlanVertices& plan_vertices;
    const BorderEdges& borders;
};

/// What was found on lines.
struct FoundWalls {
    /// Points that lines must pass first, where columns left and right of one cross in height; then
    /// there is nothing else.
    std::vector<ExtraPoint> missing;
    std::vector<WallBatch> walls;        ///< between columns, in order of lines, matched edges last
    std::vector<WallStretch> stretches;  ///< between nodes of blocks, in order of line and interval
    std::vector<std::pair<std::int32_t, std::int32_t>> links;  ///< nodes of one block that touch
};

/// Finds the walls between columns, or where `blocks` are given the walls between different blocks
/// and the nodes that are connected. Where a border runs along a line all faces on both its sides
/// are there, and what is between them is compared; elsewhere a face goes on beyond the line as it
/// is, and so do the nodes above and below it. If nothing is missing, the matched edges are given
/// back on the way.
FoundWalls find_walls(exact::PlanArrangement& geometry, const FaceList& faces,
                      CollinearEdges& collinear, const ConformedFaces& conformed,
                      const BlockLines* blocks, const Execution& execution);

}  // namespace realmodel::strata
