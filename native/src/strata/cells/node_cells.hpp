// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "strata/conform/walls.hpp"
#include "strata/overlay/sheet_links.hpp"

namespace realmodel::strata {

/// Joins nodes of one block that links, or whole triangles in common, join: on either side of a
/// whole triangle a block is thick along every edge, as bounds or the overlay found.
/// @param cell_block  filled with the block of each cell; cells are numbered in order of their
/// first
///     node
/// @return the cell of each node
std::vector<std::int32_t> cells_of_nodes(const Construction& construction,
                                         const TriangleLinks& links, const WholeTriangles& wholes,
                                         Array<std::int32_t>& cell_block,
                                         const Execution& execution);

/// Walls, and the new number of each vertex; -1 of those that are gone.
struct JoinedWalls {
    WallBatch walls;
    std::vector<std::int32_t> number;
};

/// Walls between cells from their stretches: those that go on without a change are joined, and only
/// vertices that faces or ends of walls need are kept. Afterwards the vertices of the conformed
/// faces and their positions are those that are left.
/// @param cell_of_node  of the nodes that stretches name
/// @param crossings  where heights of two columns cross, no face has a corner
JoinedWalls join_stretches(std::span<const WallStretch> stretches,
                           const std::vector<std::int32_t>& cell_of_node, const FaceList& faces,
                           std::span<const ExtraPoint> crossings, const PlanVertices& plan_vertices,
                           ConformedFaces& conformed, const Execution& execution);

}  // namespace realmodel::strata
