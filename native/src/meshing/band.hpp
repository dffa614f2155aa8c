// SPDX-License-Identifier: GPL-3.0-or-later
// What lies between a region's border and the lattices inside it.
#pragma once

#include "meshing/border_pieces.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/lattice.hpp"

namespace realmodel::meshing {

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
