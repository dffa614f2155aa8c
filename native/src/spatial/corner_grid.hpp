// SPDX-License-Identifier: GPL-3.0-or-later
// Corners of a polygon by the cells of the plan that they lie in, for ear clipping.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// Square cells with a few points each; cells that many points share are grids of their own, so
/// that clusters cost no more than what is evenly spread. Points leave one by one.
class CornerGrid {
public:
    struct Member {
        PlanPosition position;
        std::int32_t number;
    };

    /// Numbers are from 0 on and below `numbers`, each used once at most.
    CornerGrid(std::vector<Member> members, std::size_t numbers);

    /// Forgets a member; nothing where it has gone already.
    void remove(std::int32_t number);

    /// Whether `wanted` is true of a member: asked of all in the triangle a-b-c, and of others in
    /// the box around it, until it is. (Cells are found by rounded coordinates: of
    /// members within rounding of the triangle's border some may be passed over.) Searches near
    /// one another are fast one after another: each begins in the grid where the last one was.
    template <class Wanted>
    bool any_in_triangle(const PlanPosition& a, const PlanPosition& b, const PlanPosition& c,
                         Wanted&& wanted);

private:
    static constexpr std::int32_t kNone = -1;
    static constexpr std::int32_t kMostAlong = 17;  ///< columns or rows of a level

    /// `count` members from `first` on; or, where `count` is `kIsLevel`, the level `first`.
    struct Cell {
        std::int32_t first = 0, count = 0;
    };
    static constexpr std::int32_t kIsLevel = -1;
    struct Level {
        PlanPosition low, high;
        double cells_per_unit, cell_size;
        std::int32_t columns, rows;
        std::int32_t first;                          ///< of its cells
        std::uint32_t used_rows;                     ///< bits of rows that hold something
        std::array<std::uint32_t, kMostAlong> used;  ///< of each row: columns that hold something
        std::int32_t above = kNone,
                     cell_above = kNone;  ///< the level that it is in, the cell there
    };
    struct GridTriangle {
        PlanPosition a, b, c;
        PlanPosition low, high;  ///< of the box around it
    };

    std::int32_t add_level(std::span<Member> members, std::int32_t above, std::int32_t cell_above,
                           int depth);
    void set_used(Level& level, std::int32_t cell, bool is_used);
    void clear(std::int32_t level, std::int32_t cell);

    [[gnu::always_inline]] static std::int32_t cell_along(double offset, const Level& level,
                                                          std::int32_t count) {
        return static_cast<std::int32_t>(
            std::clamp(offset * level.cells_per_unit, 0.0, static_cast<double>(count - 1)));
    }
    static std::int32_t row_at(double y, const Level& level) {
        return cell_along(y - level.low[1], level, level.rows);
    }
    static std::int32_t column_at(double x, const Level& level) {
        return cell_along(x - level.low[0], level, level.columns);
    }
    /// The cell of a level that a position is in, or the one nearest to it.
    static std::int32_t cell_at(const PlanPosition& p, const Level& level) {
        return level.first + row_at(p[1], level) * level.columns + column_at(p[0], level);
    }
    /// Bits of columns, or of rows.
    static std::uint32_t bits_between(std::int32_t first, std::int32_t last) {
        return last < first ? 0 : ((2U << (last - first)) - 1) << first;
    }
    std::int32_t innermost(const GridTriangle& triangle) const;
    template <class Wanted>
    bool search(const GridTriangle& triangle, std::int32_t level, Wanted& wanted) const;

    std::vector<Level> levels_;
    std::vector<Cell> cells_;
    std::vector<Member> members_;  ///< those of a cell side by side
    /// Of each number: where its member is, none if there is kNone; the cell, and its level.
    struct Whereabouts {
        std::int32_t member = kNone, cell, level;
    };
    std::vector<Whereabouts> whereabouts_;
    std::int32_t last_ = 0;  ///< the level where the last search was
};

/// Takes in the part of the segment ab between the lines y = bottom and y = top.
[[gnu::always_inline]] inline void widen_by_band(double& low, double& high, const PlanPosition& a,
                                                 const PlanPosition& b, double bottom, double top) {
    if ((a[1] < bottom && b[1] < bottom) || (a[1] > top && b[1] > top)) return;
    const double rise = b[1] - a[1], run = b[0] - a[0];
    for (const double y : {std::clamp(a[1], bottom, top), std::clamp(b[1], bottom, top)}) {
        const double x = y == b[1] ? b[0] : y == a[1] ? a[0] : a[0] + (y - a[1]) / rise * run;
        low = std::min(low, x);
        high = std::max(high, x);
    }
}

/// The smallest level that holds all members in a triangle, found from that of the last search.
inline std::int32_t CornerGrid::innermost(const GridTriangle& triangle) const {
    const auto lies_in = [&](const Level& level, std::int32_t cell) {
        return cell_at(triangle.low, level) == cell && cell_at(triangle.high, level) == cell;
    };
    std::int32_t number = last_;
    while (levels_[number].above != kNone &&
           !lies_in(levels_[levels_[number].above], levels_[number].cell_above)) {
        number = levels_[number].above;
    }
    while (true) {
        const Level& level = levels_[number];
        const std::int32_t cell = cell_at(triangle.low, level);
        if (cells_[cell].count != kIsLevel || cell_at(triangle.high, level) != cell) return number;
        number = cells_[cell].first;
    }
}

template <class Wanted>
bool CornerGrid::any_in_triangle(const PlanPosition& a, const PlanPosition& b,
                                 const PlanPosition& c, Wanted&& wanted) {
    if (levels_.empty()) return false;
    const GridTriangle triangle{a,
                                b,
                                c,
                                {std::min({a[0], b[0], c[0]}), std::min({a[1], b[1], c[1]})},
                                {std::max({a[0], b[0], c[0]}), std::max({a[1], b[1], c[1]})}};
    last_ = innermost(triangle);
    return search(triangle, last_, wanted);
}

template <class Wanted>
bool CornerGrid::search(const GridTriangle& triangle, std::int32_t number, Wanted& wanted) const {
    const Level& level = levels_[number];
    const auto& [a, b, c, box_low, box_high] = triangle;
    const auto [left, bottom] = box_low;
    const auto [right, top] = box_high;
    if (left > level.high[0] || right < level.low[0] || bottom > level.high[1] ||
        top < level.low[1]) {
        return false;
    }
    const std::int32_t first_row = row_at(bottom, level), last_row = row_at(top, level);
    const std::int32_t first = column_at(left, level), last = column_at(right, level);
    const std::uint32_t between = bits_between(first, last);
    // Of large triangles the corners of the box are left out.
    const bool is_large = last_row - first_row > 1 && last - first > 1;
    std::uint32_t rows = level.used_rows & bits_between(first_row, last_row);
    for (; rows != 0; rows &= rows - 1) {
        const int row = std::countr_zero(rows);
        std::uint32_t used = level.used[row] & between;
        if (used == 0) continue;
        if (is_large) {
            double low = right, high = left;
            const double below = row == 0 ? bottom : level.low[1] + row * level.cell_size;
            const double above =
                row == level.rows - 1 ? top : level.low[1] + (row + 1) * level.cell_size;
            widen_by_band(low, high, a, b, below, above);
            widen_by_band(low, high, b, c, below, above);
            widen_by_band(low, high, c, a, below, above);
            used &= bits_between(column_at(low, level), column_at(high, level));
        }
        const Cell* cells = &cells_[level.first + row * level.columns];
        for (; used != 0; used &= used - 1) {
            const Cell& cell = cells[std::countr_zero(used)];
            if (cell.count == kIsLevel) {
                if (search(triangle, cell.first, wanted)) return true;
                continue;
            }
            const Member* member = &members_[cell.first];
            for (const Member* end = member + cell.count; member != end; ++member) {
                const auto [x, y] = member->position;
                // One branch instead of four: most are outside, but no one side tells which.
                const bool is_in_box = static_cast<int>(x >= left) & static_cast<int>(x <= right) &
                                       static_cast<int>(y >= bottom) & static_cast<int>(y <= top);
                if (is_in_box && wanted(*member)) return true;
            }
        }
    }
    return false;
}

}  // namespace realmodel::spatial
