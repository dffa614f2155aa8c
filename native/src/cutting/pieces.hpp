// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The words of this folder:
//
// cutter   a plane, or a surface of triangles (CutterSurface), open or closed
// side     of a cutter: kAbove, where its triangles turn counter-clockwise seen from, or outside of
//          a closed one; kBelow; kOn. Of a region of the cutter: 0 below it, 1 above it
// half     what of a model is on one side (Cut::below, Cut::above)
// node     a vertex of the model, or a new point; new ones have the numbers after the vertices
// region   of a triangle of the model or of the cutter: what is connected and no other triangle
//          passes through (SurfaceOverlay). A face's region is level where it lies on the cutter
// winding  of cells at a point: how often the boundary of each goes round it, once within it
//          (CutterWinding). Of a loop: which way it goes from its least node, 1 or -1 (winding_of)
// fan      the regions around an edge, in order; a blade of it: those in one half-plane; a sector:
//          what is between a blade and the next
// patch    regions of one face that no edge of the cutter lies between; cap: a region of the
//          cutter as one of the cells around it sees it; slot: either of them, as one cell sees it
// part     what is connected of a cell on one side (HalfCell): a cell of a half
// piece    a polygon between two parts, or around one (CutPiece): of a patch, a whole face or a cap
// shell    what is connected of the boundary of a part; around a hollow its volume is negative
// slit     an edge that a cell has the same cap on both sides of (CellCutter)
// near     of cells: they may meet the cutter; the others are far, and are copied (NearPart), as
//          are faces of near cells that are far themselves (FarFaces)

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Where a polygon of a cut model comes from, and what is on either side of it. It turns
/// counter-clockwise seen from outside of the first of its two cells. A cap has one cell twice:
/// first the part below it, then the part above.
struct CutPiece {
    std::int32_t face;                  ///< the model's face; a cap: below 0 (PartSides::cap_face)
    std::array<std::int32_t, 2> cells;  ///< the model's cells, -1 outside
    std::array<std::int8_t, 2> sides;   ///< of either cell's part; kOn: no cell there
    bool is_level;                      ///< whether it lies on the cutter
    /// The cells of the halves (HalfCell), -1 none, once they are known.
    std::array<std::int32_t, 2> parts{-1, -1};

    /// Whether it belongs to the section: between the halves, or where one of them ends.
    bool is_in_section() const { return is_level && sides[0] != sides[1]; }
};

/// Faces of a model cut up by a cutter, and the caps: what halves are put together from.
struct CutPieces {
    Polygons polygons;
    std::vector<CutPiece> origins;

    std::size_t size() const { return origins.size(); }
    CutPiece& operator[](std::size_t p) { return origins[p]; }
    const CutPiece& operator[](std::size_t p) const { return origins[p]; }
    /// @throws InputError kind too_large
    void add(std::span<const NodeId> polygon, const CutPiece& origin) {
        checked_number(origins.size(), "faces of cut cells");
        polygons.add(polygon);
        origins.push_back(origin);
    }
    /// Some of others, from one up to another.
    /// @throws InputError kind too_large
    void add(const CutPieces& others, std::size_t begin, std::size_t end) {
        checked_number(origins.size() + (end - begin), "faces of cut cells");
        polygons.add(others.polygons, begin, end);
        origins.insert(origins.end(), others.origins.begin() + static_cast<std::ptrdiff_t>(begin),
                       others.origins.begin() + static_cast<std::ptrdiff_t>(end));
    }
    void add_reversed(std::span<const NodeId> polygon, const CutPiece& origin) {
        add(polygon, origin);
        std::reverse(polygons.nodes.end() - static_cast<std::ptrdiff_t>(polygon.size()),
                     polygons.nodes.end());
    }
};

/// A piece as one of its cells sees it.
struct PieceRef {
    std::int32_t piece = 0;
    std::int32_t which = 0;  ///< 0 or 1: whose outside its polygon turns counter-clockwise from
};

/// A cell of a half: the model's cell that it is or is part of, and the half.
struct HalfCell {
    std::int32_t cell;
    std::int8_t side;
    bool is_changed = false;  ///< less than its cell though no other part of it is here
};

}  // namespace realmodel::cutting
