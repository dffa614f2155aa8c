// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/counting_sort.hpp"
#include "spatial/plan_tiles.hpp"
#include "strata/tiling/plan_links.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

using spatial::PlanBox;
using spatial::PlanTiles;
using spatial::TileSpan;

/// Where walls may stand: the borders of surfaces and of the region, and edges where a surface
/// jumps, by the tiles that they run through.
class BorderEdges {
public:
    using VertexPair = std::pair<exact::VertexId, exact::VertexId>;

    /// Edges may come several times and either way around; their lines are made where they are new.
    BorderEdges(exact::PlanArrangement& geometry, const PlanTiles& tiles,
                std::vector<VertexPair> edges);

    const PlanTiles& tiles() const { return tiles_; }
    bool in_tile(std::size_t tile) const { return !in_tiles_[tile].empty(); }
    /// Whether one runs through any of these tiles.
    bool near(const TileSpan& span) const {
        return tiles_.any(span, [&](std::size_t tile) { return in_tile(tile); });
    }
    /// Whether one has a point inside a convex polygon, whose tiles these are. Along its edges one
    /// may run.
    bool divide(LocalArrangement& scope, PolygonView polygon, const TileSpan& span) const;
    /// The same of a triangle, whose lines need not exist.
    bool divide(const exact::PlanArrangement& geometry, const PlanTriangle& triangle,
                const TileSpan& span) const;

    /// Whether one runs between two points in these tiles; neither of its ends lies between them.
    bool run_between(LocalArrangement& scope, PointId a, PointId b, const TileSpan& span) const;

private:
    struct BorderSegment {
        exact::VertexId from, to;
        LineId line;
        PlanBox box;
    };
    template <class Holds>
    bool any_in(const TileSpan& span, const Holds& holds) const;
    template <class SideOfSegment, class SideOfEdge>
    static bool reaches_inside(const BorderSegment& segment, std::size_t corners,
                               const SideOfSegment& side_of_segment,
                               const SideOfEdge& side_of_edge);

    PlanTiles tiles_;
    std::vector<BorderSegment> segments_;
    Buckets<std::uint32_t> in_tiles_;  ///< segments
};

}  // namespace realmodel::strata
