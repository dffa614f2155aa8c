// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "strata/overlay/border_edges.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/tiling/plan_grid.hpp"

namespace realmodel::strata {

/// What more is asked of facets where nodes are pieces of blocks: beneath a facet that no border
/// divides, and that touches the surface nowhere, there is one node; else each piece has its own.
struct BlockFacets {
    const BorderEdges* borders;
    std::vector<TileSpan> span;  ///< of each facet
    /// Of each facet: 1 where the tiling has all polygons over it. Only the sky and the outside may
    /// lack those that the filter of whole triangles sorted.
    std::vector<std::uint8_t> is_complete;
};

/// What facets and a surface became.
struct Overlaid {
    Envelope remaining;  ///< what is left of the facets
    PiecesBelow below;   ///< what of the surface lies beneath them
    /// Of each polygon of the surface: 1 where a piece of it does not lie below.
    std::vector<std::uint8_t> is_divided;
    /// Of each polygon, for blocks: 1 where one of its pieces is somewhere as high as the facet.
    std::vector<std::uint8_t> is_touched;
};

/// Overlays facets with a surface: beneath those pieces that lie above it nodes are closed.
/// Pieces are grouped to columns, or as `blocks` says.
/// @param wanted  as overlay_columns has it; not with `blocks`
Overlaid overlay_facets(exact::PlanArrangement& geometry, const Envelope& envelope,
                        const NumberedTiling& surface, const BlockFacets* blocks,
                        const WantedBoxes* wanted, Construction& construction,
                        const Execution& execution);

/// Lays a surface under the envelope: where it is lower, a column is closed between the two
/// and the surface becomes the envelope; elsewhere it was eroded away and the envelope stays.
/// @param wanted  where columns are; those elsewhere are left out. Nothing: all of them are
Envelope overlay_columns(exact::PlanArrangement& geometry, Envelope envelope,
                         const NumberedTiling& surface, Construction& construction,
                         const WantedBoxes* wanted, const Execution& execution);

}  // namespace realmodel::strata
