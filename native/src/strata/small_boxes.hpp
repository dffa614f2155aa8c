// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/flat_array.hpp"
#include "realmodel/base/progress.hpp"
#include "strata/overlay/polygon.hpp"

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

/// The box around all of these, which must be some.
PlanBox box_around(const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen);

/// A uniform grid of cells over a box: so many of them, as square as the box allows.
struct CellGrid {
    PlanBox frame;
    double step_x = 1, step_y = 1;
    std::int64_t columns = 0, rows = 0;

    CellGrid() = default;
    CellGrid(const PlanBox& frame, std::size_t cells);
};

/// Boxes that are hardly larger than a cell of a grid, such as those of a mesh's triangles. Each is
/// kept in one cell, that of its lower left corner, with its box beside it: who looks for boxes
/// reads some stretches of memory and nothing else.
class SmallBoxes {
public:
    /// Enters those of the chosen boxes that are small enough; returns the others.
    std::vector<std::int32_t> fill(const std::vector<PlanBox>& boxes,
                                   const std::vector<std::int32_t>& chosen, std::size_t cells,
                                   int threads, const Progress* progress);
    /// Appends the numbers of all that meet a box; of those that all but meet it, some.
    void append(const PlanBox& box, GrowingArray<std::int32_t>& found) const;

private:
    /// A box in units of cells. All coordinates come here in the same way, which never changes
    /// their order: boxes that meet still do.
    struct CellBox {
        float low_x, low_y, high_x, high_y;
    };
    /// A small box: its lower left corner, and the upper right one turned around, so that it meets
    /// another where all four numbers are at most the other's four Limits.
    struct Item {
        std::array<float, 4> corners;
        std::int32_t number;
    };
    using Limits = std::array<float, 4>;
    /// Whether an item meets a box, 1 or 0, without branches.
    static std::uint32_t meets(const Item& item, const Limits& limits);
    CellBox in_cells(const PlanBox& box) const;
    std::size_t cell_of(const CellBox& box) const;

    CellGrid grid_;
    double reach_x_ = 0, reach_y_ = 0;  ///< width and height of the largest, in cells
    FlatArray<std::uint32_t> offsets_;
    FlatArray<Item> items_;  ///< of one cell in any order
};

}  // namespace realmodel::strata
