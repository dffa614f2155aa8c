// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/convex_hull.hpp"

#include <algorithm>

#include "exact/orient2d.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

ConvexHull::ConvexHull(std::vector<Place> places) {
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    const auto add = [](std::vector<Place>& chain, const Place& place, int outward) {
        while (chain.size() > 1 &&
               exact::orient2d(chain[chain.size() - 2], chain.back(), place) != -outward) {
            chain.pop_back();
        }
        chain.push_back(place);
    };
    for (const Place& place : places) {
        add(lower_, place, -1);
        add(upper_, place, 1);
    }
}

bool ConvexHull::contains(const Place& place) const {
    if (lower_.empty() || place[0] < lower_.front()[0] || place[0] > lower_.back()[0]) return false;
    const auto left_of = [](const Place& a, double x) { return a[0] < x; };
    const auto right_of = [](double x, const Place& a) { return x < a[0]; };
    const auto low = std::lower_bound(lower_.begin(), lower_.end(), place[0], left_of);
    if ((*low)[0] == place[0] ? place[1] < (*low)[1]
                              : exact::orient2d(*(low - 1), *low, place) < 0) {
        return false;
    }
    const auto beyond = std::upper_bound(upper_.begin(), upper_.end(), place[0], right_of);
    const Place& before = *(beyond - 1);
    return before[0] == place[0] ? place[1] <= before[1]
                                 : exact::orient2d(before, *beyond, place) <= 0;
}

std::vector<ConvexHull::Place> ConvexHull::corners() const {
    std::vector<Place> corners = lower_;
    for (std::size_t i = upper_.size(); i > 2; --i)
        corners.push_back(upper_[i - 2]);
    return corners;
}

std::vector<std::uint8_t> outside_hull(std::span<const std::array<double, 3>> points,
                                       std::span<const std::array<double, 2>> nodes, int threads,
                                       Progress* progress) {
    require_finite_nodes(nodes);
    std::vector<Place> places;
    places.reserve(points.size());
    for (const auto& [x, y, z] : points)
        places.push_back({x, y});
    require_finite_nodes(places);
    const ConvexHull hull(std::move(places));
    std::vector<std::uint8_t> outside(nodes.size());
    const auto make = [&](const StopSign&) {
        return [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                outside[i] = hull.contains(nodes[i]) ? 0 : 1;
        };
    };
    for_chunks(nodes.size(), 4096, threads, progress, 0, nullptr, make);
    return outside;
}

}  // namespace realmodel::interpolation
