// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "strata/cells/volumes.hpp"
#include "strata/overlay/border_edges.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

/// What steps after the overlay make.
struct BuiltCells {
    CellComplex complex;
    std::vector<BorderVertex> border;  ///< of a tile
    Array<PlanOffset> offsets;         ///< of the first vertices; those of others are 0
};

/// What is known besides of nodes that become the cells of blocks.
struct BlockLinks {
    const TriangleLinks& triangles;
    const WholeTriangles& wholes;
    const BorderEdges& borders;
};

/// Joins the faces of a construction to a complex: without `blocks` each node is a cell, a column;
/// else what hangs together is one. Gives back what is done with on the way, so that afterwards
/// only the geometry's counts are there.
/// @param window  of a tile, or nothing
BuiltCells build_cells(exact::PlanArrangement& geometry, Construction& construction,
                       const BlockLinks* blocks, const std::vector<std::int32_t>& surface_of_plane,
                       const std::optional<Window>& window, const Execution& execution);

}  // namespace realmodel::strata
