// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Some of the vertical faces between cells. Loops counter-clockwise seen from the right of their
/// line.
struct WallBatch {
    std::vector<std::int32_t> sizes;  ///< corners of each wall
    std::vector<std::int32_t> vertices;
    std::vector<std::array<std::int32_t, 2>> cells;  ///< left and right of the line, -1 outside

    /// Adds a wall: along its lower vertices, up the far vertical, back along the upper ones and
    /// down the near vertical, through every vertex on them that is to be kept.
    template <class Keep>
    void add(std::span<const std::int32_t> lower, std::span<const std::int32_t> upper,
             const std::array<std::int32_t, 2>& beside, const Keep& is_kept) {
        const std::size_t before = vertices.size();
        const auto pass = [&](std::int32_t v) {
            if (is_kept(v)) vertices.push_back(v);
        };
        for (const std::int32_t v : lower)
            pass(v);
        for (std::int32_t v = lower.back() + 1; v < upper.back(); ++v)
            pass(v);
        const std::size_t last = upper.back() == lower.back() ? upper.size() - 1 : upper.size();
        const std::size_t first = upper.front() == lower.front() ? 1 : 0;
        for (std::size_t i = last; i-- > first;)
            pass(upper[i]);
        for (std::int32_t v = upper.front() - 1; v > lower.front(); --v)
            pass(v);
        sizes.push_back(static_cast<std::int32_t>(vertices.size() - before));
        cells.push_back(beside);
    }
};

/// A wall that may go on in the next interval of its line.
struct OpenWall {
    std::int32_t left = kOutsideCell, right = kOutsideCell;
    std::vector<std::int32_t> lower, upper;  ///< vertices along the line
};

/// Joins walls of neighboring intervals of one line: those between the same cells are one face
/// where they share a whole vertical edge, which would bound nothing.
class WallJoining {
public:
    /// Adds a wall over the present interval.
    /// @param lower, upper  its vertices at the beginning of the interval and at the end
    /// @param may_join  whether its first vertical edge is one that walls may be joined at
    void add(const std::array<std::int32_t, 2>& lower, const std::array<std::int32_t, 2>& upper,
             std::int32_t left, std::int32_t right, bool may_join) {
        OpenWall* before =
            !may_join ? open_.end()
                      : std::find_if(open_.begin(), open_.end(), [&](const OpenWall& wall) {
                            return wall.left == left && wall.right == right &&
                                   wall.lower.back() == lower[0] && wall.upper.back() == upper[0];
                        });
        OpenWall& wall = growing_.add();
        if (before == open_.end()) {
            wall.left = left;
            wall.right = right;
            wall.lower.assign(lower.begin(), lower.end());
            wall.upper.assign(upper.begin(), upper.end());
            return;
        }
        std::swap(wall, *before);
        std::rotate(before, before + 1, open_.end());
        --open_.count;
        wall.lower.push_back(lower[1]);
        wall.upper.push_back(upper[1]);
    }
    /// Ends an interval; calls emit(wall) with walls that did not go on in it.
    template <class Emit>
    void end_interval(const Emit& emit) {
        end_line(emit);
        std::swap(open_, growing_);
    }
    /// Calls emit(wall) with the walls that are open still.
    template <class Emit>
    void end_line(const Emit& emit) {
        for (const OpenWall& wall : open_)
            emit(wall);
        open_.count = 0;
    }

private:
    /// Walls that keep their memory when they are removed.
    struct OpenWalls {
        std::vector<OpenWall> all;
        std::size_t count = 0;

        OpenWall& add() {
            if (count == all.size()) all.emplace_back();
            return all[count++];
        }
        OpenWall* begin() { return all.data(); }
        OpenWall* end() { return all.data() + count; }
    };

    OpenWalls open_, growing_;
};

}  // namespace realmodel::strata
