// SPDX-License-Identifier: GPL-3.0-or-later
// The lengths that a request asks for, as a size field.
#pragma once

#include "meshing/region_graph.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// How much lengths may differ from place to place, for each unit between them.
inline constexpr double kGradation = 0.25;

/// The sources of a request's local lengths and densities. `scale` multiplies what densities ask
/// for. @throws InputError "size" and "density".
std::vector<SizeSource> requested_sources(const RegionGraph& graph, const MeshRequest& request,
                                          double edge_length, double scale);

/// About how many edges lie along the sources within a box: no mesh has fewer.
double pieces_along(std::span<const SizeSource> sources, const PlanPoint& low,
                    const PlanPoint& high);

/// The longest edge that a request by density allows: four times what the points, evenly spread
/// over the region, would ask for.
double longest_by_density(const RegionGraph& graph, const MeshRequest& request);

/// The distinct lengths that a field has over whole areas, where lattices fit: the largest, and
/// those of local lengths with room around them.
std::vector<double> lattice_lengths(const MeshRequest& request, SizeField& size);

/// About how many triangles of these sizes fill a region.
double triangles_in(const RegionGraph& graph, SizeField& size, const Check& check);

}  // namespace realmodel::meshing
