// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/counting_sort.hpp"
#include "realmodel/base/execution.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// The box around all of these, which must be some.
PlanBox box_around(const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen);

/// Boxes that are hardly larger than a cell of a grid, such as those of a mesh's triangles. Each is
/// kept in one cell, that of its lower left corner, with its box beside it: who looks for boxes
/// reads some stretches of memory and nothing else.
class SmallBoxes {
public:
    /// Enters those of the chosen boxes that are small enough; returns the others.
    std::vector<std::int32_t> fill(const std::vector<PlanBox>& boxes,
                                   const std::vector<std::int32_t>& chosen, std::size_t cells,
                                   const Execution& execution);
    /// Appends the numbers of all that meet a box; of those that all but meet it, some.
    void append(const PlanBox& box, Array<std::int32_t>& found) const;

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

    PlanTiles cells_;
    double reach_x_ = 0, reach_y_ = 0;  ///< width and height of the largest, in cells
    Buckets<Item> items_;               ///< of each cell
};

}  // namespace realmodel::spatial
