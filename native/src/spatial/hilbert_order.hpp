// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// The numbers of positions, in their order along a Hilbert curve through their extent (Hilbert
/// 1891; the turns by table as in Warren, "Hacker's Delight", section 16-1): those near each other
/// in plan mostly follow each other. Positions too near each other to be told apart stay in the
/// order in which they came.
std::vector<std::uint32_t> along_hilbert_curve(std::span<const PlanPosition> positions);

}  // namespace realmodel::spatial
