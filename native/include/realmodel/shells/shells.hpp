// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::shells {

/// The edges of polygons.
struct PolygonEdges {
    /// each once, the lower vertex first, in rising order of that
    std::vector<std::array<std::int32_t, 2>> edges;
    /// for each corner the edge from it to the next corner of its polygon
    std::vector<std::int32_t> of_corner;
};

/// @param offsets   where the corners of each polygon begin, and where the last end
/// @param corners   vertex numbers, polygon after polygon
/// @param vertices  how many vertices there are
/// @throws InputError kind bad_index (items: the polygon) where the numbers are out of range
PolygonEdges polygon_edges(std::span<const std::int32_t> offsets,
                           std::span<const std::int32_t> corners, std::size_t vertices);

/// A closed mesh of polygons, as programs that draw take it.
struct Shell {
    std::vector<std::array<float, 3>> coordinates;  ///< offsets from the origin asked for
    std::vector<std::int32_t> offsets;
    std::vector<std::int32_t> corners;   ///< counter-clockwise seen from outside
    std::vector<std::int32_t> faces;     ///< of the complex: the one that each polygon is
    std::vector<std::uint8_t> reversed;  ///< of each polygon: it is its face's second side
    PolygonEdges edges;
};

/// The closed boundary of each block, all its parts together; one without cells has an empty one.
/// Vertices and faces are in the order of the complex. The same for any number of threads.
/// @throws InputError kind bad_index (items: the face) where the numbers are out of range
/// @throws Cancelled
std::vector<Shell> block_shells(const ComplexView& complex, const std::array<double, 3>& origin,
                                const Execution& execution = {});

/// For each block the boundaries of all its cells, cell after cell; every cell has vertices of its
/// own, drawn towards their mean by the factor `shrink`. Otherwise as block_shells.
std::vector<Shell> cell_shells(const ComplexView& complex, double shrink,
                               const std::array<double, 3>& origin,
                               const Execution& execution = {});

}  // namespace realmodel::shells
