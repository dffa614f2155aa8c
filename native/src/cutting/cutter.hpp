// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "cutting/pieces.hpp"

namespace realmodel::cutting {

/// Triangles that cut a model. Those of an open surface turn counter-clockwise seen from above.
struct Cutter {
    std::vector<Position> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    bool is_closed = false;  ///< every edge has an even number of triangles

    std::array<Position, 3> corners(std::size_t triangle) const {
        const auto& t = triangles[triangle];
        return {vertices[index(t[0])], vertices[index(t[1])], vertices[index(t[2])]};
    }
};

/// An edge that an odd number of triangles have, as one of them runs, and the third corner of that.
struct CutterBorderEdge {
    NodeId from, to, corner;
};
std::vector<CutterBorderEdge> border_of(const Cutter& cutter);

/// Away from an edge, in the plane of its triangle, as long as 1.
Position away_from(const Cutter& cutter, const CutterBorderEdge& edge);

/// A surface as a user gives it: checked, triangles that are there twice left out of an open one,
/// its parts oriented upward on the whole. Where a border runs along another the edges are divided
/// so that they are shared; other borders are extended by a seam, wider than rounding, where asked.
/// @throws InputError kinds not_finite, bad_index, no_triangles, branching (an edge of three or
///         more triangles of an open surface; items: they), one_sided (items: two neighbors)
Cutter oriented_cutter(const TriangleView& cutter, bool with_seam = true);

/// The boundary of a block.
/// @throws InputError kind no_block where the model has no cell of it
Cutter block_boundary(const ComplexView& model, std::int32_t block);

}  // namespace realmodel::cutting
