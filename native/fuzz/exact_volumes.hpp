// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stack_case.hpp"

namespace realmodel::fuzz {

/// The volume of the block beneath each surface, counted through all rock masses: the closed form
/// of docs/dev/geometry.md integrated in whole numbers, rounded at the very end. Nothing is shared
/// with the builder. The plan is divided into convex polygons in each of which every surface is one
/// plane or absent, these along the lines where two planes that are compared are equally high; on
/// what is left thickness is linear.
/// @param most  convex polygons after which to give up: nothing is returned then
std::optional<std::vector<double>> exact_volumes(const StackCase& stack, std::size_t most);

}  // namespace realmodel::fuzz
