// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "validation/probes.hpp"

namespace realmodel::validation {

/// A stretch of a vertical line within one block.
struct BlockInterval {
    std::int32_t block;
    double low, high;
};

/// What the closed form of docs/dev/geometry.md says of one plan place.
struct ClosedColumn {
    std::vector<BlockInterval> intervals;               ///< upwards
    std::vector<std::optional<double>> surface_height;  ///< of the surfaces of all rock masses
    double slope = 0;                                   ///< steepest of the surfaces there
    double highest = 0;  ///< largest height of their triangles' corners, without its sign
};

/// Evaluates the closed form at a place from the triangles there (-1: none), one for each surface
/// of all rock masses. Which surface is higher is decided exactly; heights are rounded once.
ClosedColumn closed_column(const ModelInput& input, std::span<const std::int32_t> triangles,
                           const PlanPosition& place);

}  // namespace realmodel::validation
