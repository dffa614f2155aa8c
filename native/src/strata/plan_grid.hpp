// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "polygon.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::strata {

/// An axis-parallel box in plan.
struct PlanBox {
    double low_x = 0, low_y = 0, high_x = 0, high_y = 0;
    /// Whether the boxes share at least a point. Coordinates are rounded monotonically, so boxes of
    /// polygons that share an area always meet.
    bool meets(const PlanBox& other) const {
        return low_x <= other.high_x && other.low_x <= high_x && low_y <= other.high_y &&
               other.low_y <= high_y;
    }
};

PlanBox box_of(const Scope& scope, PolygonView polygon);

/// Some polygons of a set by the cells of a uniform grid, each entered in the cells that it crosses
/// row by row, so that needles and giants stay cheap.
class PolygonCells {
public:
    /// chosen: the polygons to enter; boxes: of all polygons; cells: about so many.
    void fill(const Scope& scope, const PolygonPool& polygons, const std::vector<PlanBox>& boxes,
              const std::vector<std::int32_t>& chosen, std::size_t cells, const Progress* progress);
    /// Appends the polygons whose cells and boxes meet those of `polygon`, some of them repeatedly.
    void append(const Scope& scope, PolygonView polygon, const PlanBox& box,
                const std::vector<PlanBox>& boxes, std::vector<std::int32_t>& found) const;

private:
    std::int64_t column(double x) const;
    std::int64_t row(double y) const;
    /// Calls visit(cell) for each cell that the polygon crosses.
    template <class Visit>
    void for_each_cell(const Scope& scope, PolygonView polygon, const PlanBox& box,
                       const Visit& visit) const;

    PlanBox frame_;
    double step_x_ = 1, step_y_ = 1;
    std::int64_t columns_ = 0, rows_ = 0;
    std::vector<std::int64_t> offsets_;
    std::vector<std::int32_t> items_;
};

/// Finds the polygons of a set that may share an area with another polygon. What fills the frame
/// around a surface has cells of its own: it would make those of the surface coarse.
class PlanGrid {
public:
    PlanGrid() = default;
    /// is_inner: of each polygon, whether it is the surface's; cells: at
    /// least so many of either kind.
    PlanGrid(const Scope& scope, const PolygonPool& polygons,
             const std::vector<std::uint8_t>& is_inner, std::size_t cells,
             const Progress* progress);

    /// Numbers of all polygons whose cells and boxes meet those of `polygon`, ascending.
    void candidates(const Scope& scope, PolygonView polygon,
                    std::vector<std::int32_t>& found) const;

private:
    std::vector<PlanBox> boxes_;
    PolygonCells inner_, outer_;
};

}  // namespace realmodel::strata
