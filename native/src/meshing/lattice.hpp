// SPDX-License-Identifier: GPL-3.0-or-later
// Lattices inside a region, and what lies between them and its border.
#pragma once

#include "meshing/edge_cutting.hpp"
#include "meshing/flat_mesh.hpp"

namespace realmodel::meshing {

/// How a lattice lies in the plan: rows along `axis` (a unit vector), every other one shifted by
/// half a `spacing` unless it is made of squares.
struct LatticeFrame {
    PlanPoint origin, axis;
    double spacing, row_height;
    bool is_square = false;
};

/// A lattice of triangles with sides of about `edge_length` whose rows run along the direction that
/// most of the border has (modulo 60 degrees), one of them along the longest edge that has it.
/// Stretched by at most 1.5 % so that it meets that edge's ends and the opposite border.
LatticeFrame fitting_frame(const RegionGraph& graph, double edge_length);

struct TriangleLattice {
    std::vector<PlanPoint> points;  ///< row after row
    /// Triangles whose corners are all there; in `points` and among themselves. A triangle lies
    /// wholly inside the region.
    FlatMesh mesh;
    std::vector<HalfEdge> rim;         ///< the sides with no triangle behind them
    std::vector<std::int32_t> loners;  ///< points that no triangle has
};

/// The points of a lattice that lie in the region, where `size` asks for `edge_length` and nothing
/// else, and at least `clearance` (edge lengths) from its border and inner lines. From a clearance
/// of 0.6 on, nothing of these can pass between the corners of a triangle; squares are left out
/// where something might. Time and memory grow with the points made and the pieces, not with the
/// bounding box.
TriangleLattice lattice_inside(const BorderPieces& border, std::span<const std::int32_t> loners,
                               const LatticeFrame& frame, SizeField& size, double edge_length,
                               double clearance, const Check& check);

/// A region's triangles before any is improved: lattices, and the constrained Delaunay
/// triangulation of the band between them and the border.
struct BandedMesh {
    FlatMesh mesh;                   ///< vertices: the border's points, then those of the lattices
    std::int32_t first_of_band = 0;  ///< triangles before it are a lattice's
    std::vector<std::int32_t> rim_triangles;  ///< of lattices, beside the band
};

/// Joins border and lattices; lattices are used up.
BandedMesh join_band(BorderPieces&& border, std::span<const std::int32_t> loners,
                     std::vector<TriangleLattice>&& lattices, const Check& check);

/// The same without lattices: the triangulation of the graph with its edges cut.
FlatMesh mesh_without_lattice(const RegionGraph& graph, const BorderPieces& border, double finest,
                              const Check& check);

}  // namespace realmodel::meshing
