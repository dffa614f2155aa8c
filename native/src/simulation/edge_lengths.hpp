// SPDX-License-Identifier: GPL-3.0-or-later
/// How long the edges of tetrahedra should be at each place in plan.
#pragma once

#include <array>
#include <span>

#include "meshing/size_field.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "simulation/boundary_faces.hpp"

namespace realmodel::simulation {

/// As mesh_region has them, and its gradation. A size without places means the sharp edges, seen
/// in plan.
/// @throws InputError kinds size (items: its number; a length that is below `tolerance`, or no
/// shorter than `edge_length`), too_large
meshing::SizeField edge_lengths(const ComplexView& model, const BoundaryFaces& faces,
                                double edge_length, double tolerance,
                                std::span<const meshing::LocalLength> sizes);

/// About how many cubes with these edges fill a box, of which any part of the plan has one at
/// least. @throws InputError kind too_large (where edges differ in length, and there are more than
/// `most`); Cancelled
double cubes_in(meshing::SizeField& lengths, const std::array<double, 3>& low,
                const std::array<double, 3>& high, double most, Progress* progress);

}  // namespace realmodel::simulation
