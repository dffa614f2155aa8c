// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "structures/structure_surface.hpp"

namespace realmodel::structures {

/// How much of a fault lies on each side of another one.
struct BranchSides {
    double above = 0, below = 0;  ///< areas
    bool meets = false;           ///< whether the faults themselves have a point in common
};

/// Of a fault that ends at another one, and of that with its continuation. Divided exactly, near
/// the rock and away from it.
BranchSides branch_sides(const StructureSurface& surface, std::int32_t branch, std::int32_t other);

/// On which side of the other one the larger part of its area lies.
/// @throws InputError kind does_not_meet
std::int8_t kept_side(const StructureSurface& surface, std::int32_t branch, std::int32_t other);

}  // namespace realmodel::structures
