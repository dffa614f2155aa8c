// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::interpolation {

/// The convex hull of points in plan, as its two chains from the lexicographically least corner to
/// the greatest (Andrew 1979). Exact.
class ConvexHull {
public:
    using PlanPosition = std::array<double, 2>;

    explicit ConvexHull(std::vector<PlanPosition> positions);

    /// On the border is inside. A hull of no positions contains none.
    bool contains(const PlanPosition& position) const;

private:
    std::vector<PlanPosition> lower_, upper_;
};

/// The numbers of the positions on the border of the convex hull of some, no two of which are
/// equal, counterclockwise from the lexicographically least; of positions in one line all, from
/// one end. Exact.
std::vector<std::int32_t> hull_border(std::span<const std::array<double, 2>> positions);

/// 1 for each node outside the convex hull of the points, else 0.
/// @throws InputError kind "not_finite"
/// @throws Cancelled
std::vector<std::uint8_t> outside_hull(std::span<const std::array<double, 3>> points,
                                       std::span<const std::array<double, 2>> nodes,
                                       const Execution& execution = {});

}  // namespace realmodel::interpolation
