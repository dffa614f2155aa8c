// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/inverse_distance.hpp"

#include <cmath>
#include <cstdio>

#include "interpolation/neighbors/neighbor_search.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

/// A weighted mean that grows point by point.
class Mean {
public:
    Mean(double nearest_squared_distance, double power)
        : nearest_(nearest_squared_distance), half_power_(power / 2) {}

    void add(double squared_distance, double value) {
        // Relative to the nearest point, so that no power overflows.
        const double closeness = nearest_ / squared_distance;
        const double weight = half_power_ == 1 ? closeness : std::pow(closeness, half_power_);
        sum_ += weight * value;
        weights_ += weight;
    }
    double value() const { return sum_ / weights_; }

private:
    double nearest_, half_power_;
    double sum_ = 0, weights_ = 0;
};

void check_options(const InverseDistanceOptions& options) {
    if (!(options.power > 0) || !std::isfinite(options.power)) {
        char text[80];
        std::snprintf(text, sizeof text, "the power is %.6g; it must be positive", options.power);
        throw InputError("option", text);
    }
    check_neighbourhood({options.neighbours, options.octants, options.radius});
}

/// nodes: none for the data's own places, each told by the others.
std::vector<double> means(const DataPoints& data, std::span<const Place> nodes, bool leave_out,
                          const InverseDistanceOptions& options, Progress* progress) {
    const spatial::NearestPoints tree(data.local);
    const std::size_t count = leave_out ? data.local.size() : nodes.size();
    const bool all = options.neighbours == 0 && options.octants == 0 && options.radius == 0;
    const Neighbourhood neighbourhood{all ? 1 : options.neighbours, options.octants,
                                      options.radius};
    std::vector<double> z(count);
    const auto make = [&](const StopSign& stop) {
        return
            [&, search = NeighbourSearch(data, tree, neighbourhood),
             near = std::vector<spatial::Neighbour>()](std::size_t begin, std::size_t end) mutable {
                for (std::size_t i = begin; i < end && !stop(); ++i) {
                    const Place node = leave_out ? data.local[i] : data.to_local(nodes[i]);
                    const std::int32_t left_out =
                        leave_out ? static_cast<std::int32_t>(i) : NeighbourSearch::nobody;
                    search.find(node, near, left_out);
                    if (near.empty()) {
                        z[i] = data.values[i];
                        continue;
                    }
                    const spatial::Neighbour nearest = near.front();
                    // Values count from the nearest one: heights far from 0 lose no digits.
                    const double base = data.values[static_cast<std::size_t>(nearest.point)];
                    if (nearest.squared_distance == 0) {
                        z[i] = base;
                        continue;
                    }
                    Mean mean(nearest.squared_distance, options.power);
                    if (all) {
                        for (std::size_t p = 0; p < data.local.size(); ++p) {
                            if (static_cast<std::int32_t>(p) == left_out) continue;
                            const double dx = node[0] - data.local[p][0],
                                         dy = node[1] - data.local[p][1];
                            mean.add(dx * dx + dy * dy, data.values[p] - base);
                        }
                    } else {
                        for (const spatial::Neighbour& n : near) {
                            mean.add(n.squared_distance,
                                     data.values[static_cast<std::size_t>(n.point)] - base);
                        }
                    }
                    z[i] = base + mean.value();
                }
            };
    };
    const std::size_t chunk = all ? 1 + 1'000'000 / data.local.size() : 256;
    for_chunks(count, chunk, options.threads, progress, 0, "inverse distance", make);
    return z;
}

}  // namespace

std::vector<double> inverse_distance(std::span<const std::array<double, 3>> points,
                                     std::span<const std::array<double, 2>> nodes,
                                     const InverseDistanceOptions& options, Progress* progress) {
    check_options(options);
    require_finite_nodes(nodes);
    return means(prepare_points(points), nodes, false, options, progress);
}

std::vector<double> inverse_distance_left_out(std::span<const std::array<double, 3>> points,
                                              const InverseDistanceOptions& options,
                                              Progress* progress) {
    check_options(options);
    const DataPoints data = prepare_points(points);
    const std::vector<double> of_places = means(data, {}, true, options, progress);
    std::vector<double> z(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        z[i] = of_places[static_cast<std::size_t>(data.place_of[i])];
    return z;
}

}  // namespace realmodel::interpolation
