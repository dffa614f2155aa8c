// SPDX-License-Identifier: GPL-3.0-or-later
// Better shapes for the triangles that are no lattice's. Private.
#pragma once

#include <span>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// Improves the triangles from `first` on, those in `also`, and their neighbours, in rounds of
///   - flips and collapses that bring vertices nearer to six neighbours (Frey and Field 1991, "Mesh
///     relaxation"; on fixed lines: to triangles of 60 degrees),
///   - moves of one vertex at a time, by Newton's method, to where the sum of the inverse mean
///     ratios of its triangles is least (Munson 2007, "Mesh shape-quality optimization using the
///     inverse mean-ratio metric"): within the star of a vertex this sum is convex.
/// In the end all but fixed sides are Delaunay again. Vertices on fixed sides, and those in `kept`,
/// stay; but of those from number `corners` on that lie between two corners of the
/// border, where sizes vary, some slide along it and some are taken out. Vertices that were
/// collapsed are used by no triangle. Deterministic.
void smooth(FlatMesh& mesh, const SizeField& size, std::int32_t first,
            std::span<const std::int32_t> also, std::int32_t corners,
            std::span<const std::int32_t> kept, const Check& check);

}  // namespace realmodel::meshing
