// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "strata/overlay/rules.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

/// What is carried along while rules are replayed for blocks: the top so far, or the floor. Where
/// there is none its parts are void.
struct BlockBound {
    BlockTiling tiling;
    std::vector<Cover> cover;  ///< of each tile without a border
};

/// Rules on tilings of which most triangles stay whole.
class BlockRaising {
public:
    using Tiling = BlockTiling;
    using Bound = BlockBound;

    BlockRaising(exact::PlanArrangement& geometry, const TriangleLinks& links,
                 const BorderEdges& borders, double largest_height, const Execution& execution)
        : geometry_(geometry),
          links_(links),
          filter_(geometry, borders, largest_height, execution),
          execution_(execution) {}

    void begin(const BlockTiling& surface) { filter_.begin(surface); }
    BlockTiling raise(const BlockTiling& surface, const BlockBound& bound);
    BlockBound first(const BlockTiling& e);
    BlockBound cover(const BlockBound& older, const BlockTiling& newer, const BlockTiling&);

private:
    static FacetView view(const BlockBound& bound) {
        return {bound.tiling.whole,      {}, bound.tiling.parts,
                bound.tiling.part_plane, {}, bound.cover};
    }
    SurfaceTiling exact_facets(const BlockTiling& bound);

    exact::PlanArrangement& geometry_;
    const TriangleLinks& links_;
    WholeTriangleFilter filter_;
    Execution execution_;
};

}  // namespace realmodel::strata
