// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/nearest_distance.hpp"

#include "realmodel/base/errors.hpp"
#include "realmodel/spatial/queries.hpp"

namespace realmodel::interpolation {

std::vector<double> nearest_distances(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes,
                                      const Execution& execution) {
    if (points.empty()) throw InputError("no_points", "there are no points to be near to");
    const auto& origin = points[0];  // at UTM coordinates differences keep all their digits
    std::vector<std::array<double, 2>> from, to;
    for (const auto& [x, y, z] : points)
        from.push_back({x - origin[0], y - origin[1]});
    for (const auto& [x, y] : nodes)
        to.push_back({x - origin[0], y - origin[1]});
    return spatial::nearest_points(from, to, 1, execution).distance;
}

}  // namespace realmodel::interpolation
