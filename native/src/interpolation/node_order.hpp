// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes in an order in which neighbours in plan are mostly neighbours. Private.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"

namespace realmodel::interpolation {

/// The numbers of places, in their order along a Hilbert curve through their extent (Hilbert 1891;
/// the turns by table as in Warren, "Hacker's Delight", section 16-1). Places too near each other
/// to be told apart stay in the order in which they came.
std::vector<std::uint32_t> along_curve(std::span<const Place> places);

}  // namespace realmodel::interpolation
