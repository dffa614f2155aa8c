// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/simulation/filled_mesh.hpp"

namespace realmodel::simulation {

/// Divides tetrahedra with more than one face on the outside, with their neighbors, until each has
/// at most one: others have inner faces in two directions only, or in one, and no solver can
/// compute a gradient there. Tetrahedra without an inner face are left out.
/// @throws Cancelled
void divide_corner_tetrahedra(FilledMesh& mesh, Progress* progress);

/// Six times the volume, positive where the corners are in order.
double six_volumes(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners);

}  // namespace realmodel::simulation
