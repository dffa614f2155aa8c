// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/progress.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// Volume of every block: the sum of its cells, each by the divergence theorem about one of its own
/// corners, so that coordinates far from the origin cost no digits.
std::vector<double> block_volumes(const CellComplex& complex, std::size_t blocks,
                                  const Progress* progress);

}  // namespace realmodel::strata
