// SPDX-License-Identifier: GPL-3.0-or-later
// Better shapes for the triangles that are no lattice's.
#pragma once

#include <span>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// Improves the triangles from `first` on, those in `also`, and their neighbors, in rounds of
///   - flips and collapses that bring vertices nearer to six neighbors (Valences),
///   - ways of several flips that bring a vertex of five and one of seven neighbors to their
///     opposites, and flips that make bad triangles better (JudgedFlips),
///   - moves of one vertex at a time to where its triangles are best (StarMoves).
/// In the end all but fixed edges are Delaunay again. Vertices on fixed edges, and those in `kept`,
/// stay; but of those from number `corners` on that lie between two corners of the
/// border, where sizes vary, some slide along it and some are taken out. Vertices that were
/// collapsed are used by no triangle. Deterministic.
void smooth(FlatMesh& mesh, SizeField& size, std::int32_t first, std::span<const std::int32_t> also,
            std::int32_t corners, std::span<const std::int32_t> kept, const Check& check);

}  // namespace realmodel::meshing
