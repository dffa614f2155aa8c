// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// By how much what is exact differs in x and y from its rounded position.
using PlanOffset = std::array<float, 2>;

/// Volume of every block: what lies beneath the faces that bound it from above, less what lies
/// beneath those that bound it from below. Heights are counted from a corner of each cell, so that
/// coordinates far from the origin cost no digits. The same for any number of threads.
/// @param offsets  of the first vertices: where they are exactly
std::vector<double> block_volumes(const CellComplex& complex, std::size_t blocks,
                                  const Execution& execution,
                                  std::span<const PlanOffset> offsets = {});

}  // namespace realmodel::strata
