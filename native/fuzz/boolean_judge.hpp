// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "complex_defects.hpp"
#include "stack_case.hpp"

namespace realmodel::fuzz {

/// What is wrong with the intersection of two surfaces: judged in rational numbers, on the surfaces
/// themselves and by rays, with nothing of the code that intersects them.
///
/// - the triangles of the refinement meet in common corners and edges only, or coincide;
/// - intersected again nothing changes, and two threads give the same as one;
/// - the parts of each triangle make up that triangle, as far as rounding allows;
/// - results of operations are closed, and contain places taken at random where they must;
/// - their volumes add up, and so do those of the sub-blocks;
/// - loops consist of intersection edges, each once, and are of the kind that they say.
std::vector<Defect> boolean_defects(const StackCase& pair, std::uint64_t seed);

}  // namespace realmodel::fuzz
