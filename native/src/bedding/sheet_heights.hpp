// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
#include "realmodel/strata/stack.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::bedding {

using spatial::PlanPosition;

/// Heights of a sheet at plan positions. Its triangles are kept by the tiles that their boxes meet.
class SheetHeights {
public:
    enum class State : std::uint8_t {
        kAbsent,  ///< no triangle is there
        kHeight,  ///< one height
        kBorder   ///< a border or a step of the sheet is there: a side has to be chosen
    };
    struct Found {
        State state;
        double height;
    };

    /// @param near  what rounding may move a position by
    /// @throws InputError kind bad_index (items: the triangle)
    SheetHeights(const TriangleView& sheet, double near);

    Found at(const PlanPosition& position) const;
    /// The height at a border, on the side where another position lies, close by.
    Found beside(const PlanPosition& other, const PlanPosition& position) const;

private:
    struct Triangle {
        std::array<PlanPosition, 3> corner;  ///< counter-clockwise
        std::array<double, 3> height;
        std::array<double, 3> slack;  ///< of the edge from a corner to the next: length times near
        std::uint8_t border_edges = 0, border_corners = 0;  ///< bits

        /// Twice the areas of the position with each edge.
        std::array<double, 3> areas(const PlanPosition& p) const {
            std::array<double, 3> found{};
            for (std::size_t i = 0; i < 3; ++i) {
                found[i] = twice_area(corner[i], corner[(i + 1) % 3], p);
            }
            return found;
        }
        double height_from(const std::array<double, 3>& areas) const;
        /// Whether a border passes within `near` of a position beside the triangle.
        bool has_border_near(const PlanPosition& p, const std::array<double, 3>& areas,
                             double near) const;
    };
    void add_triangles(const TriangleView& sheet);

    double near_;
    double same_ = 0;  ///< heights that differ by less are one: a step that nobody sees
    std::vector<Triangle> triangles_;
    spatial::PlanTiles tiles_;
    Buckets<std::int32_t> triangles_at_;  ///< of each tile
};

}  // namespace realmodel::bedding
