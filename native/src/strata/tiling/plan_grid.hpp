// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/base/execution.hpp"
#include "spatial/small_boxes.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

using spatial::PlanBox;
using spatial::PlanTiles;
using spatial::TileSpan;

PlanBox box_of(const LocalArrangement& scope, PolygonView polygon);

/// Some polygons of a set by the cells of a uniform grid, each entered in the cells that it crosses
/// row by row, so that needles and giants stay cheap.
class PolygonCells {
public:
    /// chosen: the polygons to enter; boxes: of all polygons; cells: about so many.
    void fill(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
              const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen,
              std::size_t cells, const Execution& execution);
    /// Appends the polygons whose cells and boxes meet those of `polygon`; whether none of them
    /// comes repeatedly.
    bool append(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                const std::vector<PlanBox>& boxes, Array<std::int32_t>& found) const;

private:
    /// A polygon in a cell. Of those entered in all cells of a box, the first column and row: two
    /// such polygons meet for the first time in a cell that follows from them.
    struct Item {
        std::int32_t polygon, left, low;
    };
    static constexpr std::int32_t kScattered = -1;

    bool is_inside(const PlanBox& box) const;
    /// Calls visit(cell) for each cell that the polygon crosses.
    template <class Visit>
    void for_each_cell(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                       const Visit& visit) const;

    PlanTiles cells_;
    Buckets<Item> items_;  ///< of each cell
};

/// Finds the polygons of a set that may share an area with another polygon. Most of a surface's are
/// small; what is larger, and what fills the frame around the surface, has cells of its own.
class PlanGrid {
public:
    PlanGrid() = default;
    /// is_inner: of each polygon, whether it is the surface's; cells: at
    /// least so many of either kind.
    PlanGrid(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
             const std::vector<std::uint8_t>& is_inner, std::size_t cells,
             const Execution& execution);

    /// Numbers of all polygons whose cells and boxes meet those of `polygon`, ascending.
    void candidates(const LocalArrangement& scope, PolygonView polygon,
                    Array<std::int32_t>& found) const;

private:
    std::vector<PlanBox> boxes_;
    spatial::SmallBoxes small_;
    PolygonCells large_, outer_;
};

}  // namespace realmodel::strata
