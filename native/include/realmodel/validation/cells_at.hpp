// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::validation {

/// The cell that each position lies in, -1 for none; the first where rounding made cells overlap.
/// Exact for the triangles into which faces are divided from their first corners; a position on a
/// face is above it. The arrays must have passed check_topology.
/// @throws Cancelled
std::vector<std::int32_t> cells_at(const ComplexView& model,
                                   std::span<const std::array<double, 3>> positions,
                                   const Execution& execution = {});

}  // namespace realmodel::validation
