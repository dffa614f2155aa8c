// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/nearest_distance.hpp"

#include <cmath>

#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

std::vector<double> nearest_distances(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes,
                                      const Execution& execution) {
    if (points.empty()) throw InputError("no_points", "there are no points to be near to");
    require_countable(points.size(), "points");
    require_finite_nodes(nodes);
    std::vector<Position> positions;
    positions.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        // From the first point: at UTM coordinates differences keep all their digits.
        positions.push_back({points[i][0] - points[0][0], points[i][1] - points[0][1]});
        if (std::isfinite(positions[i][0]) && std::isfinite(positions[i][1])) continue;
        throw InputError("not_finite", "point " + std::to_string(i) + " is not finite", -1,
                         {static_cast<std::int64_t>(i)});
    }
    const spatial::NearestPoints tree(positions);
    std::vector<double> out(nodes.size());
    const NodeLoop loop{nodes.size(), 1024, execution, "distances to points"};
    loop.over_nodes(
        [] { return std::vector<spatial::Neighbor>(); },
        [&](std::vector<spatial::Neighbor>& near, std::size_t i) {
            tree.find({nodes[i][0] - points[0][0], nodes[i][1] - points[0][1]}, 1, near);
            out[i] = std::sqrt(near[0].squared_distance);
        });
    return out;
}

}  // namespace realmodel::interpolation
