// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

// Points or lines side by side, so that one question is asked of all of them at once: most are
// answered by floating point, several at a time; the rest one by one, exactly.
namespace realmodel::exact {

/// So many points or lines in a row at most.
inline constexpr std::size_t kRowLength = 12;

/// Which of a row's points lie left of a line and which right of it, or of which of a row's lines a
/// point lies left or right: a bit for each; neither where the point is on the line.
struct Sides {
    std::uint32_t left = 0, right = 0;
};

/// Points by their numbers, with their positions.
struct PointRow {
    std::size_t size = 0;
    bool within = true;  ///< the reach of the input vertices
    std::array<std::int32_t, kRowLength> point;
    std::array<double, kRowLength> x, y;

    void clear() {
        size = 0;
        within = true;
    }
};

/// Directed lines: the value of each at (x, y) is a (x - x0) + b (y - y0) + c, and no further from
/// the true one than its bound where the point is within the reach of the input vertices.
struct LineRow {
    std::size_t size = 0;
    std::array<std::int32_t, kRowLength> line;
    std::array<double, kRowLength> a, b, c, bound, x0, y0;

    void clear() { size = 0; }
};

}  // namespace realmodel::exact
