// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/strata/stack.hpp"
#include "spatial/box_tree.hpp"
#include "spatial/plan_tiles.hpp"
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
                const std::vector<PlanBox>& boxes, Array<std::int32_t>& numbers) const;

private:
    /// A polygon in a cell. Of those entered in all cells of a box, the first column and row: two
    /// such polygons meet for the first time in a cell that follows from them.
    struct CellPolygon {
        std::int32_t polygon, left, low;
    };
    static constexpr std::int32_t kScattered = -1;

    bool is_inside(const PlanBox& box) const;
    /// Calls visit(cell) for each cell that the polygon crosses.
    template <class Visit>
    void for_each_cell(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                       const Visit& visit) const;

    PlanTiles cells_;
    Buckets<CellPolygon> items_;  ///< of each cell
};

/// Finds the polygons of a set that may share an area with another polygon. What fills the frame
/// around a surface has cells of its own.
class PlanGrid {
public:
    PlanGrid() = default;
    /// is_inner: of each polygon, whether it is the surface's; cells: four times those of the
    /// surface's polygons, where there are not as many polygons.
    PlanGrid(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
             const std::vector<std::uint8_t>& is_inner, std::size_t cells,
             const Execution& execution);

    /// Numbers of all polygons whose cells and boxes meet those of `polygon`, ascending.
    void candidates(const LocalArrangement& scope, PolygonView polygon,
                    Array<std::int32_t>& numbers) const;

private:
    std::vector<PlanBox> boxes_;
    PolygonCells inner_, outer_;
};

/// The most layers that a grid may have.
inline constexpr std::size_t kMostLayers = 64;

/// Answers whether anything is wanted in a box. Above and below the grid it is, beside the grid as
/// in its nearest cells.
class WantedBoxes {
public:
    explicit WantedBoxes(const WantedSpace& space);

    bool any_in(const spatial::Box& box) const;

private:
    std::uint64_t layers_up_to(double height) const;
    std::size_t cell(std::size_t axis, double coordinate) const;

    WantedSpace space_;
    std::vector<std::uint64_t> layers_;  ///< of each cell in plan, a bit for each layer
};

}  // namespace realmodel::strata
