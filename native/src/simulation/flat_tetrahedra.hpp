// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/simulation/filled_mesh.hpp"

namespace realmodel::simulation {

/// Makes flat tetrahedra thicker by moving their corners: those inside regions as far as it takes,
/// those inside of one surface between regions by half of `tolerance` at most, no others. No
/// element near them becomes flatter than the flattest there was.
/// @return how many are left
/// @throws Cancelled
std::size_t thicken_flat_tetrahedra(FilledMesh& mesh, double tolerance, Progress* progress);

/// How far a tetrahedron is from flat: the determinant of the sum of n n^T over its faces, by eight
/// (n: the normal, as long as the face's area over the mean area). It is 0.3 where all edges are
/// alike; OpenFOAM's checkMesh calls cells below 0.001 under-determined.
double roundness(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners);

}  // namespace realmodel::simulation
