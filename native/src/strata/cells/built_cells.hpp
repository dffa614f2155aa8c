// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// By how much what is exact differs in x and y from its rounded place.
using PlanOffset = std::array<float, 2>;

/// What steps after the overlay make.
struct BuiltCells {
    CellComplex complex;
    std::vector<BorderVertex> border;  ///< of a tile
    Array<PlanOffset> offsets;         ///< of the first vertices; those of others are 0
};

}  // namespace realmodel::strata
