// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "realmodel/complex.hpp"
#include "realmodel/simulation/filled_mesh.hpp"
#include "simulation/boundary_faces.hpp"

namespace realmodel::simulation {

/// Gives each outside face of the mesh the surface of the exact outside face that it comes from.
/// Corners that are off it (where a sharp edge is cut short, or flat elements were left out) move
/// onto it where the elements around stay positive, or are covered by new elements, so that walls
/// and flat bases stay in their planes.
/// @param reach  how far corners may lie from the face that they come from, and move
/// @throws Cancelled
void sort_outside_faces(FilledMesh& mesh, const ComplexView& model,
                        std::span<const BoundaryTriangle> triangles, double reach,
                        Progress* progress);

}  // namespace realmodel::simulation
