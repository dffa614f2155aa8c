// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "arrangement/triangle_arrangement.hpp"

// Pictures of what is divided, as strata/dump.hpp has them of the stack: nothing in the library
// calls these. From a debugger that has stopped at an assertion, e.g.
//   call realmodel::arrangement::dump_regions(points_, arrangement_, "/tmp/regions.obj")

namespace realmodel::arrangement {

/// Triangles that were divided: of each with regions a group "triangle_N", with the outlines of its
/// regions as faces and the holes in them as lines.
void dump_regions(const exact::SpacePoints& points, const TriangleArrangement& arrangement,
                  const char* path);

}  // namespace realmodel::arrangement
