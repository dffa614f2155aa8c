// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/nearest_distance.hpp"

#include <cmath>

#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

std::vector<double> nearest_distances(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes, int threads,
                                      Progress* progress) {
    if (points.empty()) throw InputError("no_points", "there are no points to be near to");
    require_finite_nodes(nodes);
    std::vector<Place> places;
    places.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        // From the first point: at UTM coordinates differences keep all their digits.
        places.push_back({points[i][0] - points[0][0], points[i][1] - points[0][1]});
        if (std::isfinite(places[i][0]) && std::isfinite(places[i][1])) continue;
        throw InputError("not_finite", "point " + std::to_string(i) + " is not finite", -1,
                         {static_cast<std::int64_t>(i)});
    }
    const spatial::NearestPoints tree(places);
    std::vector<double> out(nodes.size());
    for_chunks(
        nodes.size(), 1024, threads, progress, 0, "distances to points", [&](const StopSign&) {
            return [&, near = std::vector<spatial::Neighbour>()](std::size_t begin,
                                                                 std::size_t end) mutable {
                for (std::size_t i = begin; i < end; ++i) {
                    tree.find({nodes[i][0] - points[0][0], nodes[i][1] - points[0][1]}, 1, near);
                    out[i] = std::sqrt(near[0].squared_distance);
                }
            };
        });
    return out;
}

}  // namespace realmodel::interpolation
