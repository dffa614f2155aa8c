// SPDX-License-Identifier: GPL-3.0-or-later
// Data points checked and made ready for interpolation. Private.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace realmodel::interpolation {

using Place = std::array<double, 2>;

/// Points of which no two lie at one place. Coordinates are kept as they came (to find again a node
/// on a point) and relative to an origin among them (to reckon with: at UTM coordinates differences
/// keep all their digits).
struct DataPoints {
    std::vector<Place> places;  ///< in order of appearance
    std::vector<Place> local;   ///< places minus origin
    std::vector<double> values;
    std::vector<std::int32_t> place_of;  ///< for each point that was given, its place
    Place origin{};

    Place to_local(const Place& place) const {
        return {place[0] - origin[0], place[1] - origin[1]};
    }
};

/// Merges points that repeat another. Throws InputError of kind "no_points", "not_finite" (items:
/// the point), "contradicting_points" (two values at one place; items: both points; place).
DataPoints prepare_points(std::span<const std::array<double, 3>> points);

/// Throws InputError "not_finite" (items: the node).
void require_finite_nodes(std::span<const Place> nodes);

}  // namespace realmodel::interpolation
