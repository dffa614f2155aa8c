// SPDX-License-Identifier: GPL-3.0-or-later
// What is small about a region's border.
#pragma once

#include <vector>

#include "meshing/region_graph.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// Where border, inner lines and points are too close to one another for edges as long as `size`
/// wants: the short pieces that a coarse refinement without regard to size leaves there, whose
/// lengths follow the local feature size (Ruppert 1995, theorem 1).
std::vector<SizeSource> border_detail(const RegionGraph& graph, SizeField& size, double least_angle,
                                      double shortest_edge, std::size_t most_vertices,
                                      const Check& check);

}  // namespace realmodel::meshing
