// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/joined_rounding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::structures {

using cutting::Position;

namespace {

/// Whether corners do not lie in the plane that fits them, by more than the rounding of their
/// coordinates.
bool is_warped(std::span<const Position> corners) {
    constexpr double kUnits = 8;  // in the last place, by which coordinates may be off
    const Position normal = polygon_normal(corners);
    double allowed = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double largest = 0;
        for (const Position& p : corners)
            largest = std::max(largest, std::abs(p[axis]));
        allowed += kUnits * std::abs(normal[axis]) * (std::nextafter(largest, HUGE_VAL) - largest);
    }
    return !std::ranges::all_of(corners, [&](const Position& p) {
        return std::abs(dot(normal, minus(p, corners[0]))) <= allowed;
    });
}

}  // namespace

void round_joined_parts(cutting::RoundedParts&& parts, const std::array<bool, 2>& touches,
                        double least_rounding) {
    assert(parts.are_joined && parts.are_closed());
    // The order of cutting::round_parts(). Short edges come after nodes in one position, for each
    // is weighed by what the parts are like without these, and what faces each other then cancels
    // before nodes are set apart. Nodes in the middle of polygons may make others the same once
    // more. Where a part touches itself is only known at the end.
    merge_needles(parts, least_rounding);
    cutting::drop_hollow(parts);
    cutting::level_base(parts);
    cutting::join_coincident(parts, touches, true);
    join_short_edges(parts, least_rounding);
    cancel_facing(parts);
    cutting::set_apart(parts);
    cutting::give_extents(parts);
    cutting::divide_bent(parts, cutting::glue_doubled(parts), is_warped);
    parts.update();
    cancel_facing(parts);
    set_touching_apart(parts);
    cutting::drop_empty(parts);
    assert(parts.are_closed() && parts.are_apart());
}

}  // namespace realmodel::structures
