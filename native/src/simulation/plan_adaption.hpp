// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/flat_mesh.hpp"
#include "simulation/line_edges.hpp"

namespace realmodel::simulation {

/// Makes a planar mesh fit for columns, in this order:
/// 1. Border triangles with two edges outside are flipped where that leaves no sharp angle, else
///    divided: an element there would have neighbors in one direction only.
/// 2. Triangles that steps bound are divided until each has at most one edge on a step, and the
///    corner across from it has one post.
/// 3. Sharp angles, which the first two leave behind, are made larger by flips and moves of nodes
///    that are on no line, and where that is not enough by dividing edges on lines.
void adapt_plan(meshing::FlatMesh& mesh, LineEdges& edges);

}  // namespace realmodel::simulation
