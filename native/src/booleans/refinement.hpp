// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/booleans/intersect.hpp"

namespace realmodel::booleans {

using Position = std::array<double, 3>;

// Notation of this folder. How space is divided has that of arrangement/space_cells.hpp.
//
//   P, Q      the two surfaces, sources 0 and 1. Either may be open and may cross itself
//   input     a triangle of P or Q, counted through both; its row is its number in its surface
//   piece     an input as a whole, or a part of it; turned as the input is (TrianglePieces)
//   corner    a vertex of a piece: always a point that doubles give. A point that divides pieces
//             exactly is a vertex once it is rounded, which moves it
//   fresh     of a piece: it has changed since it was last known to meet others in order
//   order     two pieces meet in order where they have nothing in common but corners and edges that
//             they share, or coincide
//   meeting   where two pieces meet out of order (ExactDivision)
//   near      what is closer than rounding can keep apart (Nearness): a vertex to another one, to
//             an edge or a facet; two edges that pass each other
//   round     fresh pieces are divided where they meet out of order (ExactDivision), or what is
//             near there is brought together (Snapping). When no piece is fresh, what is left are
//   refined   a piece of the result, which meets all others in order (RefinedTriangles)
//   facet     refined pieces that coincide, as one (FacetMesh); times: how often it is a piece of P
//             and of Q, -1 for each that faces the other way
//   winding   how often P and Q go round a cell of space. They go once round what is below them, so
//             from below a facet to above it they change by -times; around an edge of a closed
//             surface these changes add up to zero (FacetCells)

/// A triangle of one of the surfaces, or a part of it.
struct RefinedTriangle {
    std::array<std::int32_t, 3> corners;
    std::int32_t origin;  ///< the triangle of the input that it is part of
    std::uint8_t source;  ///< which surface

    bool operator==(const RefinedTriangle&) const = default;
};

/// Triangles that meet in common edges and vertices only, or coincide.
struct RefinedTriangles {
    std::vector<Position> vertices;          ///< all different, each a corner of a triangle
    std::vector<RefinedTriangle> triangles;  ///< by source, then by origin
};

/// Divides the triangles of both surfaces along one another and themselves.
///
/// What meets in something that doubles cannot keep is brought together first. Then, in rounds:
/// triangles are divided exactly, new vertices are rounded, and what meets out of order after that
/// is brought together or divided again, until nothing does. Where that takes many rounds, vertices
/// are rounded to coarser and coarser steps, which merges them. Where it does not end, more is
/// brought together before anything is divided.
///
/// @throws InputError kinds not_finite, bad_index, no_triangles, too_large, too_close; Cancelled
RefinedTriangles refine(const std::array<TriangleView, 2>& surfaces, const Execution& execution);

}  // namespace realmodel::booleans
