// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "spatial/plan_tiles.hpp"

namespace realmodel::interpolation {

using PlanPosition = spatial::PlanPosition;

/// Points of which no two lie at one position on one sheet. Their coordinates are relative to an
/// origin among them: at UTM coordinates differences keep all their digits.
struct DataPoints {
    std::vector<PlanPosition> local;  ///< in order of appearance
    std::vector<double> values;
    std::vector<std::int32_t> number_of;  ///< for each point that was given, its number here
    PlanPosition origin{};
    std::vector<std::int32_t> sheets{};  ///< that each is on; empty: there is one

    PlanPosition to_local(const PlanPosition& position) const {
        return {position[0] - origin[0], position[1] - origin[1]};
    }
    /// What was found for each of these points, for each point that was given.
    std::vector<double> for_input_points(std::span<const double> point_values) const;
};

/// Merges points that repeat another.
/// @throws InputError kind "no_points", "not_finite" (items: the point), "contradicting_points"
/// (two
///         values at one position; items: both points; place), "too_large"
/// @param sheets  that each is on; empty: there is one
DataPoints prepare_points(std::span<const std::array<double, 3>> points,
                          std::span<const std::int32_t> sheets = {});

/// Whether a number can be squared.
bool usable(double number);
/// @throws InputError kind "not_finite" (items: `i`, the number of what has the numbers)
void require_usable(std::span<const double> numbers, const char* what, std::size_t i);

/// A fixed, even subset of the numbers below `count`: at most `most` of them, ascending.
std::vector<std::int32_t> even_subset(std::size_t count, std::size_t most);

/// @throws InputError kind "not_finite" (items: the node)
void require_finite_nodes(std::span<const PlanPosition> nodes);

/// Points and nodes are numbered by 32 bits.
/// @throws InputError kind "too_large"
void require_countable(std::size_t count, const char* what);

}  // namespace realmodel::interpolation
