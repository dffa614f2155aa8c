// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace realmodel {
class Progress;
}

namespace realmodel::interpolation {

/// The convex hull of points in plan, as its two chains from the lexicographically least corner to
/// the greatest (Andrew 1979). Exact.
class ConvexHull {
public:
    using Place = std::array<double, 2>;

    explicit ConvexHull(std::vector<Place> places);

    /// On the border is inside. Of no places: never.
    bool contains(const Place& place) const;

    /// Corners counter-clockwise, without those that lie in a straight border.
    std::vector<Place> corners() const;

private:
    std::vector<Place> lower_, upper_;
};

/// 1 for each node outside the convex hull of the points, else 0.
/// Throws InputError of kind "not_finite"; Cancelled.
std::vector<std::uint8_t> outside_hull(std::span<const std::array<double, 3>> points,
                                       std::span<const std::array<double, 2>> nodes, int threads,
                                       Progress* progress = nullptr);

}  // namespace realmodel::interpolation
