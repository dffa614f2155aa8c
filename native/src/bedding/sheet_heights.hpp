// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
#include "realmodel/strata/stack.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::bedding {

using spatial::PlanPosition;

enum class State : std::uint8_t {
    kAbsent,  ///< no triangle is there
    kHeight,  ///< one height
    kBorder   ///< a border or a step of the sheet is there: a side has to be chosen
};

/// The triangles of a sheet in plan, kept by the tiles that their boxes meet. Sheets whose heights
/// alone differ share one, so that a position is located once for all of them.
class SheetPlan {
public:
    using Areas = std::array<double, 3>;
    struct Place {
        State state = State::kAbsent;
        std::int32_t triangle = -1;
        Areas areas{};  ///< twice those of the position with each edge of the triangle
    };

    /// @param near  what rounding may move a position by
    /// @throws InputError kind bad_index (items: the triangle)
    SheetPlan(const TriangleView& sheet, double near);

    /// The vertices of the triangles that have an area in plan, counter-clockwise.
    std::span<const std::array<std::int32_t, 3>> triangles() const { return numbers_; }
    Place at(const PlanPosition& position) const;
    /// A triangle that holds a position, or none: -1.
    std::int32_t holding(const PlanPosition& position) const;
    Areas areas(std::int32_t triangle, const PlanPosition& position) const;
    /// Calls visit(triangle, areas) for those that hold a position or are near it.
    template <class Visit>
    void for_each_near(const PlanPosition& position, const Visit& visit) const;

private:
    struct Triangle {
        std::array<PlanPosition, 3> corner;
        std::array<double, 3> slack;  ///< of the edge from a corner to the next: length times near
        std::uint8_t border_edges = 0, border_corners = 0;  ///< bits

        Areas areas(const PlanPosition& p) const {
            Areas found{};
            for (std::size_t i = 0; i < 3; ++i) {
                found[i] = twice_area(corner[i], corner[(i + 1) % 3], p);
            }
            return found;
        }
        bool is_near(const Areas& areas) const {
            return areas[0] >= -slack[0] && areas[1] >= -slack[1] && areas[2] >= -slack[2];
        }
        /// Whether a border passes within `near` of a position beside the triangle.
        bool has_border_near(const PlanPosition& p, const Areas& areas, double near) const;
    };
    void add_triangles(const TriangleView& sheet);
    void find_borders(std::size_t vertices);

    double near_;
    std::vector<Triangle> triangles_;
    std::vector<std::array<std::int32_t, 3>> numbers_;
    spatial::PlanTiles tiles_;
    Buckets<std::int32_t> triangles_at_;  ///< of each tile
};

/// Heights of a sheet at plan positions.
class SheetHeights {
public:
    struct Found {
        State state;
        double height;
    };

    /// @param plan  that of the sheet, which has to outlive this
    SheetHeights(const SheetPlan& plan, const TriangleView& sheet);

    Found at(const SheetPlan::Place& place) const;
    /// The height at a border, on the side of a triangle that is there; -1: no triangle.
    Found beside(std::int32_t there, const PlanPosition& position) const;

private:
    double height(std::int32_t triangle, const SheetPlan::Areas& areas) const;

    const SheetPlan* plan_;
    double same_ = 0;  ///< heights that differ by less are one: a step that nobody sees
    std::vector<std::array<double, 3>> heights_;  ///< of the corners of each triangle
};

}  // namespace realmodel::bedding
