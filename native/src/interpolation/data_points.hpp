// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace realmodel::interpolation {

/// x and y in plan.
using Position = std::array<double, 2>;

using Place = Position;  // in the spatial indexes

/// The box around some positions.
struct Bounds {
    Position low, high;

    double width() const { return high[0] - low[0]; }
    double height() const { return high[1] - low[1]; }
};
/// @param positions  at least one
Bounds bounds_of(std::span<const Position> positions);

/// Points of which no two lie at one position. Their coordinates are relative to an origin among
/// them: at UTM coordinates differences keep all their digits.
struct DataPoints {
    std::vector<Position> local;  ///< in order of appearance
    std::vector<double> values;
    std::vector<std::int32_t> number_of;  ///< for each point that was given, its number here
    Position origin{};

    Position to_local(const Position& position) const {
        return {position[0] - origin[0], position[1] - origin[1]};
    }
    /// What was found for each of these points, for each point that was given.
    std::vector<double> for_given(std::span<const double> found) const;
};

/// Merges points that repeat another.
/// @throws InputError kind "no_points", "not_finite" (items: the point), "contradicting_points"
/// (two
///         values at one position; items: both points; place), "too_large"
DataPoints prepare_points(std::span<const std::array<double, 3>> points);

/// A fixed, even part of the numbers below `count`: at most `most` of them, ascending.
std::vector<std::int32_t> even_part(std::size_t count, std::size_t most);

/// @throws InputError kind "not_finite" (items: the node)
void require_finite_nodes(std::span<const Position> nodes);

/// Points and nodes are numbered by 32 bits.
/// @throws InputError kind "too_large"
void require_countable(std::size_t count, const char* what);

}  // namespace realmodel::interpolation
