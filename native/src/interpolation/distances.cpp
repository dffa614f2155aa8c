// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/distances.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "interpolation/neighbors/neighbor_search.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/spatial/queries.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

void check_options(const InverseDistanceOptions& options) {
    if (!(options.power > 0) || !std::isfinite(options.power)) {
        char text[80];
        std::snprintf(text, sizeof text, "the power is %.6g; it must be positive", options.power);
        throw InputError("option", text);
    }
    check_neighborhood(options.neighborhood);
}

/// @param leave_out  the means are those of the data's own positions, each from the others
std::vector<double> means(const DataPoints& data, std::span<const PlanPosition> nodes,
                          bool leave_out, const InverseDistanceOptions& options,
                          const Execution& execution) {
    const spatial::NearestPoints tree(data.local);
    const std::size_t points = data.local.size();
    Neighborhood neighborhood = options.neighborhood;
    const bool all = neighborhood.neighbors == 0 && neighborhood.plain();
    if (all) neighborhood.neighbors = 1;
    std::vector<double> z(leave_out ? points : nodes.size());
    struct DistanceScratch {
        NeighborSearch search;
        std::vector<spatial::Neighbor> near;
    };
    const NodeLoop loop{z.size(), all ? 1 + 1'000'000 / points : 256, execution,
                        "inverse distance"};
    loop.over_nodes(
        [&] {
            return DistanceScratch{NeighborSearch(data, tree, neighborhood), {}};
        },
        [&](DistanceScratch& scratch, std::size_t i) {
            const PlanPosition node = leave_out ? data.local[i] : data.to_local(nodes[i]);
            const std::int32_t left_out =
                leave_out ? static_cast<std::int32_t>(i) : NeighborSearch::kNobody;
            scratch.search.find(node, scratch.near, left_out);
            if (scratch.near.empty()) {
                z[i] = data.values[i];
                return;
            }
            const spatial::Neighbor nearest = scratch.near.front();
            // Values count from the nearest one: heights far from 0 lose no digits.
            const double base = data.values[nearest.point];
            if (nearest.squared_distance == 0) {
                z[i] = base;
                return;
            }
            double sum = 0, weights = 0;
            const auto add = [&](double squared_distance, std::int32_t point) {
                // Relative to the nearest point, so that no power overflows.
                const double closeness = nearest.squared_distance / squared_distance;
                const double weight =
                    options.power == 2 ? closeness : elementary::pow(closeness, options.power / 2);
                sum += weight * (data.values[point] - base);
                weights += weight;
            };
            for (const spatial::Neighbor& n : scratch.near) {
                if (!all) add(n.squared_distance, n.point);
            }
            for (std::int32_t p = 0; all && std::cmp_less(p, points); ++p) {
                const double dx = node[0] - data.local[p][0], dy = node[1] - data.local[p][1];
                if (p != left_out) add(dx * dx + dy * dy, p);
            }
            z[i] = base + sum / weights;
        });
    return z;
}

}  // namespace

std::vector<double> inverse_distance(std::span<const std::array<double, 3>> points,
                                     std::span<const std::array<double, 2>> nodes,
                                     const InverseDistanceOptions& options,
                                     const Execution& execution) {
    check_options(options);
    require_finite_nodes(nodes);
    return means(prepare_points(points), nodes, false, options, execution);
}

std::vector<double> inverse_distance_left_out(std::span<const std::array<double, 3>> points,
                                              const InverseDistanceOptions& options,
                                              const Execution& execution) {
    check_options(options);
    const DataPoints data = prepare_points(points);
    return data.for_input_points(means(data, {}, true, options, execution));
}

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
