// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The words of this folder:
//
// cutter      a plane, or triangles of one surface or several (Cutter), open or closed
// side        of a cutter: kAbove, where its triangles turn counter-clockwise seen from, or outside
//             of a closed one; kBelow; kOn. As an index 0 is below and 1 above
// half        what of a model is on one side (Cut::below, Cut::above)
// node        a vertex of the model, or a new point; new ones have the numbers after the vertices
// region      of a triangle of the model or of the cutter: what is connected and no other triangle
//             passes through (CutterOverlay). A face's region may coincide with one of the cutter's
// winding     winding numbers of cells at a point: how often the boundary of each goes round it,
//             once within it (CutterWinding). Of a loop: which way it goes from its least node
//             (winding_of)
// fan         the regions around an edge, in the order of the half-planes that they are in; a
//             sector: what is between a half-plane and the next
// face piece  regions of one face that no edge of the cutter lies between
// cut face    a region of the cutter as one of the cells around it sees it
// half-face   a face piece or a cut face, as seen from one cell
// compartment what is connected of space where the cutter is not (CutterCompartments)
// part        what is connected of a cell on one side (HalfCell): a cell of a half
// piece       a polygon between two parts, or around one (CutPiece): of a face piece, a whole face
//             or a cut face
// shell       what is connected of the boundary of a part; around a hollow its volume is negative
// slit        an edge in a cut face that its outline passes there and back (CellCutter)
// near        cells that may meet the cutter; the others are far and are copied (NearModel), as are
//             far faces of near cells (FarFaces)

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/triangulate.hpp"
#include "realmodel/cutting/cut.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

using arrangement::CornerTurns;
using arrangement::divide_convex;
using arrangement::Loop;
using arrangement::LoopCorner;
using arrangement::NodeId;
using arrangement::PlanePosition;
using arrangement::Polygons;
using arrangement::Position;
using arrangement::rounding_of;
using arrangement::triangulate;
using arrangement::View;

/// Sides of a cutter: above it or outside of it, on it, below it or inside.
inline constexpr std::int8_t kAbove = 1, kOn = 0, kBelow = -1;

// The faces of a model as polygons.

/// Checks that arrays which may come from anywhere name only what is there.
/// @throws InputError kind bad_model
void check_model(const ComplexView& model);

/// Around a polygon of the model's vertices.
inline spatial::Box box_of(const ComplexView& model, std::span<const NodeId> polygon) {
    return spatial::bounding_box(polygon, [&](NodeId v) { return model.vertex(v); });
}

std::vector<Position> positions_of(const ComplexView& model, std::span<const NodeId> polygon);

/// A polygon of the model's vertices as a loop in the view along its normal, and the rounding of
/// its corners.
std::pair<Loop, PlanePosition> loop_of(const ComplexView& model, std::span<const NodeId> polygon);

/// A face divided into triangles, always the same ones for the same face: numbers of its corners.
void triangulate_face(const ComplexView& model, std::size_t face,
                      std::vector<std::array<std::int32_t, 3>>& triangles);

/// A face in convex polygons, which are added.
void divide_face(const ComplexView& model, std::size_t face, Polygons& polygons);

// What a cutter makes of them.

/// Where a polygon of a cut model comes from, and what is on either side of it. It turns
/// counter-clockwise seen from outside of the first of its two cells. A cut face has one cell
/// twice: first the part below it, then the part above.
struct CutPiece {
    std::int32_t face;  ///< the model's face; a cut face: below 0 (PartSides::cut_face_number)
    std::array<std::int32_t, 2> cells;  ///< the model's cells, -1 outside
    std::array<std::int8_t, 2> sides;   ///< of either cell's part; kOn: no cell there
    bool is_on_cutter;                  ///< whether it lies on the cutter
    /// The cells of the halves (HalfCell), -1 none, once they are known.
    std::array<std::int32_t, 2> parts{-1, -1};

    /// Whether it belongs to the section: between the halves, or where one of them ends.
    bool is_in_section() const { return is_on_cutter && sides[0] != sides[1]; }
};

/// Faces of a model cut up by a cutter, and the cut faces: what halves are put together from.
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
