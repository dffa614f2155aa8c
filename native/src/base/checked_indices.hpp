// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that arrays which may come from anywhere name only what there is. All throw InputError
// kind bad_index, with the number of the item as its only one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "base/index.hpp"

namespace realmodel {

/// @param kind  of the item: "face"
[[noreturn]] inline void refuse_index(const char* kind, std::size_t item, const char* what,
                                      int surface = -1) {
    throw InputError("bad_index", std::string(kind) + " " + std::to_string(item) + " " + what,
                     surface, {static_cast<std::int64_t>(item)});
}

/// The corners of an item are vertices.
inline void require_vertices(const char* kind, std::size_t item,
                             std::span<const std::int32_t> corners, std::size_t vertices,
                             int surface = -1) {
    for (const std::int32_t v : corners) {
        if (v < 0 || index(v) >= vertices)
            refuse_index(kind, item, "refers to a vertex that does not exist", surface);
    }
}

/// So are those of triangles, of which three make one each.
inline void require_triangles(std::span<const std::int32_t> corners, std::size_t vertices,
                              int surface = -1) {
    for (std::size_t i = 0; i < corners.size(); ++i)
        require_vertices("triangle", i / 3, corners.subspan(i, 1), vertices, surface);
}

/// The cells on both sides of a face are there, or -1.
inline void require_cells(std::size_t face, const std::array<std::int32_t, 2>& cells,
                          std::size_t count) {
    for (const std::int32_t cell : cells) {
        if (cell < -1 || std::cmp_greater_equal(cell, count))
            refuse_index("face", face, "refers to a cell that does not exist");
    }
}

/// The corners of a polygon, which must be there.
/// @param offsets  where those of each polygon begin, and where the last end
template <class Offset>
std::span<const std::int32_t> checked_corners(const char* kind, std::size_t polygon,
                                              std::span<const Offset> offsets,
                                              std::span<const std::int32_t> corners,
                                              std::int64_t min_corners) {
    const std::int64_t begin = offsets[polygon], end = offsets[polygon + 1];
    if (begin < 0 || end < begin + min_corners || std::cmp_greater(end, corners.size()))
        refuse_index(kind, polygon, "has corners that do not exist, or too few");
    return corners.subspan(index(begin), index(end - begin));
}

}  // namespace realmodel
