// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/flat_array.hpp"
#include "realmodel/base/progress.hpp"
#include "strata/overlay/polygon.hpp"
#include "strata/small_boxes.hpp"

namespace realmodel::strata {

PlanBox box_of(const LocalArrangement& scope, PolygonView polygon);

/// Some polygons of a set by the cells of a uniform grid, each entered in the cells that it crosses
/// row by row, so that needles and giants stay cheap.
class PolygonCells {
public:
    /// chosen: the polygons to enter; boxes: of all polygons; cells: about so many.
    void fill(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
              const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen,
              std::size_t cells, int threads, const Progress* progress);
    /// Appends the polygons whose cells and boxes meet those of `polygon`; whether none of them
    /// comes repeatedly.
    bool append(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                const std::vector<PlanBox>& boxes, GrowingArray<std::int32_t>& found) const;

private:
    /// Columns and rows that a box meets.
    struct CellSpan {
        std::int64_t left, right, low, high;
        bool is_narrow() const { return right - left <= 1 || high - low <= 1; }
    };
    /// A polygon in a cell. Of those entered in all cells of a box, the first column and row: two
    /// such polygons meet for the first time in a cell that follows from them.
    struct Item {
        std::int32_t polygon, left, low;
    };
    static constexpr std::int32_t kScattered = -1;

    CellSpan span_of(const PlanBox& box) const;
    bool is_inside(const PlanBox& box) const;
    std::int64_t column(double x) const;
    std::int64_t row(double y) const;
    /// Calls visit(cell) for each cell that the polygon crosses.
    template <class Visit>
    void for_each_cell(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                       const Visit& visit) const;

    CellGrid grid_;
    FlatArray<std::uint32_t> offsets_;
    FlatArray<Item> items_;  ///< of one cell in any order
};

/// Finds the polygons of a set that may share an area with another polygon. Most of a surface's are
/// small; what is larger, and what fills the frame around the surface, has cells of its own.
class PlanGrid {
public:
    PlanGrid() = default;
    /// is_inner: of each polygon, whether it is the surface's; cells: at
    /// least so many of either kind.
    PlanGrid(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
             const std::vector<std::uint8_t>& is_inner, std::size_t cells, int threads,
             const Progress* progress);

    /// Numbers of all polygons whose cells and boxes meet those of `polygon`, ascending.
    void candidates(const LocalArrangement& scope, PolygonView polygon,
                    GrowingArray<std::int32_t>& found) const;

private:
    std::vector<PlanBox> boxes_;
    SmallBoxes small_;
    PolygonCells large_, outer_;
};

}  // namespace realmodel::strata
