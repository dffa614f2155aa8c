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

/// Finds the polygons of a set that may share an area with another polygon: a uniform grid, each
/// polygon entered in the cells that it crosses row by row, so that needles and giants stay cheap.
class PlanGrid {
public:
    PlanGrid() = default;
    PlanGrid(const Scope& scope, const PolygonPool& polygons, const Progress* progress);

    /// Numbers of all polygons whose cells and boxes meet those of `polygon`, ascending.
    void candidates(const Scope& scope, PolygonView polygon,
                    std::vector<std::int32_t>& found) const;

private:
    struct RowSpan {
        std::int64_t first, last;
    };
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
    std::vector<PlanBox> boxes_;
};

}  // namespace realmodel::strata
