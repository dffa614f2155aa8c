// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/triangle_view.hpp"

namespace realmodel::cutting {

/// A plane through `point`; "above" is where `normal` points. The normal may have any length.
struct Plane {
    std::array<double, 3> point, normal;
};

/// What lies on the cutter: convex polygons, counter-clockwise seen from above (or outside).
struct Section {
    Array<std::array<double, 3>> vertices;
    std::vector<std::int64_t> offsets{0};
    std::vector<std::int32_t> polygon_vertices;
    /// The model's cells below (inside) and above (outside): twice the same where a cell is cut,
    /// two where the cutter runs between cells, -1 where one side is outside of the model.
    std::vector<std::array<std::int32_t, 2>> cells;
};

/// Both halves of a model, and what lies between them. Their cut faces are the section's polygons,
/// the half above has them turned over. Cells that fall apart become several.
struct Cut {
    CellComplex below, above;
    /// The model's cell that each cell of a half is, or is part of.
    std::vector<std::int32_t> below_cells, above_cells;
    /// Whether cells of a half use an edge more than twice, though the model's do not: a surface
    /// may touch itself, or a face, along an edge.
    bool below_touches = false, above_touches = false;
    Section section;
};

/// Cuts a model by a plane. A vertex lies above it, below it, or exactly on it; all else follows
/// from these sides: an edge is cut once where its ends lie on different sides, a face along the
/// straight lines between such places. Where a place rounds to an end of its edge, vertices within
/// half a unit in the last place of the plane are contracted to it.
/// @throws InputError kinds not_finite, bad_plane (the normal is zero), bad_model
/// @throws Cancelled
Cut cut_by_plane(const ComplexView& model, const Plane& plane, const Execution& execution);

/// The section alone, in a fraction of the time.
Section section_by_plane(const ComplexView& model, const Plane& plane, const Execution& execution);

/// Cuts a model by a surface of triangles in any position that parts it: open, and ending outside
/// of the model or on its outside, or closed. Above is where an open one turns its upper side (on
/// the whole); below, or inside, of a closed one is what a way out leaves through it an odd number
/// of times. Where surface and faces meet is decided exactly, on the model's coordinates and the
/// surface's; vertices of the model within their own rounding of the surface are taken to lie on
/// it. The model's cells may overlap by rounding (docs/dev/geometry.md, "Cutting").
/// @throws InputError kinds not_finite, bad_index, no_triangles, bad_model; of open surfaces
///         branching, one_sided, ends_inside (it does not part the model; the place), two_sides (a
///         place is above one part of it and below another)
/// @throws Cancelled
Cut cut_by_surface(const ComplexView& model, const TriangleView& surface,
                   const Execution& execution);

/// Cuts a model by the boundary of a block of another, or of its own: below is what is inside.
/// @throws InputError kinds no_block, bad_model
/// @throws Cancelled
Cut cut_by_block(const ComplexView& model, const ComplexView& other, std::int32_t block,
                 const Execution& execution);

/// The vertical section over a stretch in plan, from `start` to `end`: one panel of a fence
/// diagram. Above is to its right, so that polygons turn counter-clockwise where distance runs to
/// the right and height upward.
/// @throws InputError kinds not_finite, bad_plane (both ends are the same), bad_model
/// @throws Cancelled
Section fence_panel(const ComplexView& model, const std::array<double, 2>& start,
                    const std::array<double, 2>& end, const Execution& execution);

/// Faces divided into triangles of their corners; those of face f are triangles offsets[f] to
/// offsets[f + 1].
struct FaceTriangles {
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<std::int64_t> offsets{0};
};

/// The faces of a complex divided into triangles, turned as their faces are; always the same ones
/// for the same face. A face may have corners in one line. Each of its edges is an edge of one of
/// its triangles, so what faces close, the triangles close.
/// @throws InputError kind bad_index (items: the face); Cancelled
FaceTriangles triangulate_faces(std::span<const double> vertices,
                                std::span<const std::int64_t> face_offsets,
                                std::span<const std::int32_t> face_vertices,
                                const Execution& execution);

}  // namespace realmodel::cutting
