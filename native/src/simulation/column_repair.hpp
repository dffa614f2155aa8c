// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/progress.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/post_levels.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

/// Columns whose levels change until solvers can compute on the elements between them.
/// @throws InputError kind too_large
LayeredMesh repaired_columns(const ColumnInput& input, const VerticalFaults& faults,
                             const Layering& layering, Progress* progress);

}  // namespace realmodel::simulation
