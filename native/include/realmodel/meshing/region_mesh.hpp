// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel {
class Progress;
}

namespace realmodel::meshing {

/// What a mesh will take, told before it is made.
struct MeshEstimate {
    double triangles;
    double bytes;  ///< at the peak
};

/// Estimates mesh_region's work from the region's area and border. Throws as mesh_region does.
MeshEstimate estimate_region_mesh(std::span<const Ring> rings, double edge_length);

/// Meshes what lies inside an odd number of rings with triangles of about one edge length.
///
/// Equilateral triangles of side `edge_length` fill the open; the border is cut into pieces of
/// about that length, and the band between is a constrained Delaunay triangulation, refined until
/// no angle is below 27 degrees but those between two edges of the outlines, grading down to their
/// detail (detail below a thousandth of the edge length is kept but not graded to). The border of
/// the mesh is the outlines' corners and points added on their edges, nothing else. Vertices: the
/// corners in order of appearance, the points added on edges, the others.
///
/// The same input gives the same mesh. `progress` may be null.
/// Throws InputError as triangulate_region does (rings.hpp), and of kind
/// - "edge_length" (not positive and finite, or too small for doubles to tell points apart here),
/// - "too_large" (more triangles than memory or 32-bit numbers allow; says how many, and the least
///   edge length that fits),
/// - "too_close" (outlines so near each other that points added on them collide; place);
/// Cancelled within 0.2 s of Progress::cancel.
PlanarMesh mesh_region(std::span<const Ring> rings, double edge_length,
                       Progress* progress = nullptr);

}  // namespace realmodel::meshing
