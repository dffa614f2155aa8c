// SPDX-License-Identifier: GPL-3.0-or-later
// Corners of a polygon by the cells of the plan that they lie in, for ear clipping. Private.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// Square cells with a few points each; cells that many points share are grids of their own, so
/// that clusters cost no more than what is evenly spread. Points leave one by one.
class CornerGrid {
public:
    /// Takes those of the places that `members` names.
    CornerGrid(std::span<const PlanPoint> places, std::span<const std::int32_t> members);

    /// Forgets a member; nothing where it has gone already.
    void remove(std::int32_t member);

    /// Whether `wanted` is true of a member: asked of all in the triangle a-b-c, and of others
    /// nearby, until it is. (Cells are found by rounded coordinates: of members within rounding of
    /// the triangle's border some may be passed over.)
    template <class Wanted>
    bool any_in_triangle(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                         Wanted&& wanted) const {
        return !levels_.empty() && search({a, b, c}, 0, wanted);
    }

    /// The same of the few members around a place: those in its cell and in the cells beside it.
    template <class Wanted>
    bool any_beside(const PlanPoint& p, Wanted&& wanted) const;

private:
    using Triangle = std::array<PlanPoint, 3>;
    /// What a cell holds: a member, the first of a list; `empty`; or, below that, a level.
    static constexpr std::int32_t empty = -1;
    static std::int32_t level_in(std::int32_t held) { return empty - 1 - held; }
    struct Level {
        PlanPoint low, high;
        double cells_per_unit, side;
        std::int32_t columns, rows;
        std::int32_t first;                        ///< of its cells
        std::int32_t used;                         ///< cells that hold something
        std::int32_t above = empty, cell = empty;  ///< the level that it is in, and the cell there
    };

    std::int32_t add_level(std::span<std::int32_t> members, std::int32_t cell, int depth);
    static std::int32_t cell_along(double offset, const Level& level, std::int32_t count) {
        return static_cast<std::int32_t>(
            std::clamp(offset * level.cells_per_unit, 0.0, static_cast<double>(count - 1)));
    }
    template <class Wanted>
    bool search(const Triangle& triangle, std::int32_t level, Wanted& wanted) const;
    template <class Wanted>
    bool any_in_list(std::int32_t head, Wanted& wanted) const {
        for (std::int32_t m = head; m >= 0; m = after_[m])
            if (wanted(m)) return true;
        return false;
    }

    std::span<const PlanPoint> places_;
    std::vector<Level> levels_;
    std::vector<std::int32_t> cells_;
    // Of each place: the members before and after it in its cell's list, the cell, and its level;
    // no level if it is no member.
    std::vector<std::int32_t> before_, after_, cell_, level_of_;
};

/// Takes in the part of the segment ab between the lines y = bottom and y = top.
inline void widen_by_band(double& low, double& high, const PlanPoint& a, const PlanPoint& b,
                          double bottom, double top) {
    if ((a[1] < bottom && b[1] < bottom) || (a[1] > top && b[1] > top)) return;
    const double rise = b[1] - a[1], run = b[0] - a[0];
    for (const double y : {std::clamp(a[1], bottom, top), std::clamp(b[1], bottom, top)}) {
        const double x = y == b[1] ? b[0] : y == a[1] ? a[0] : a[0] + (y - a[1]) / rise * run;
        low = std::min(low, x);
        high = std::max(high, x);
    }
}

template <class Wanted>
bool CornerGrid::search(const Triangle& triangle, std::int32_t number, Wanted& wanted) const {
    const Level& level = levels_[number];
    const auto& [a, b, c] = triangle;
    const double left = std::min({a[0], b[0], c[0]}), right = std::max({a[0], b[0], c[0]});
    const double bottom = std::min({a[1], b[1], c[1]}), top = std::max({a[1], b[1], c[1]});
    if (left > level.high[0] || right < level.low[0] || bottom > level.high[1] ||
        top < level.low[1]) {
        return false;
    }
    const std::int32_t first_row = cell_along(bottom - level.low[1], level, level.rows),
                       last_row = cell_along(top - level.low[1], level, level.rows);
    const std::int32_t first = cell_along(left - level.low[0], level, level.columns),
                       last = cell_along(right - level.low[0], level, level.columns);
    for (std::int32_t row = first_row; row <= last_row; ++row) {
        std::int32_t from = first, to = last;
        if (last_row - first_row > 1 && last - first > 1) {
            double low = right, high = left;
            const double below = row == 0 ? bottom : level.low[1] + row * level.side;
            const double above =
                row == level.rows - 1 ? top : level.low[1] + (row + 1) * level.side;
            widen_by_band(low, high, a, b, below, above);
            widen_by_band(low, high, b, c, below, above);
            widen_by_band(low, high, c, a, below, above);
            from = cell_along(low - level.low[0], level, level.columns);
            to = cell_along(high - level.low[0], level, level.columns);
        }
        const std::int32_t* cell = &cells_[level.first + row * level.columns];
        for (std::int32_t column = from; column <= to; ++column) {
            const std::int32_t held = cell[column];
            if (held == empty) continue;
            if (held > empty ? any_in_list(held, wanted)
                             : search(triangle, level_in(held), wanted)) {
                return true;
            }
        }
    }
    return false;
}

template <class Wanted>
bool CornerGrid::any_beside(const PlanPoint& p, Wanted&& wanted) const {
    constexpr std::int32_t reach = 1;
    if (levels_.empty()) return false;
    for (std::int32_t number = 0;;) {
        const Level& level = levels_[number];
        const std::int32_t row = cell_along(p[1] - level.low[1], level, level.rows),
                           column = cell_along(p[0] - level.low[0], level, level.columns);
        const std::int32_t held = cells_[level.first + row * level.columns + column];
        if (held < empty) {
            number = level_in(held);
            continue;
        }
        for (std::int32_t r = std::max(0, row - reach); r <= std::min(level.rows - 1, row + reach);
             ++r) {
            const std::int32_t* cell = &cells_[level.first + r * level.columns];
            for (std::int32_t k = std::max(0, column - reach);
                 k <= std::min(level.columns - 1, column + reach); ++k) {
                if (cell[k] > empty && any_in_list(cell[k], wanted)) return true;
            }
        }
        return false;
    }
}

}  // namespace realmodel::meshing
