// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbour_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t looked_at = 64;  // times the points wanted, until octants may stay empty

std::size_t octant(double dx, double dy) {
    return (dx < 0 ? 4U : 0U) + (dy < 0 ? 2U : 0U) + (std::abs(dx) < std::abs(dy) ? 1U : 0U);
}

}  // namespace

void check_neighbourhood(const Neighbourhood& neighbourhood) {
    if (neighbourhood.neighbours < 0) {
        throw InputError("option", "the number of neighbours is negative; 0 means all points");
    }
    if (neighbourhood.octants < 0) {
        throw InputError("option", "the number of points in an octant is negative; 0 means any");
    }
    if (!(neighbourhood.radius >= 0) || !std::isfinite(neighbourhood.radius)) {
        throw InputError("option", "the radius is negative or infinite; 0 means no limit");
    }
}

NeighbourSearch::NeighbourSearch(const DataPoints& data, const spatial::NearestPoints& tree,
                                 const Neighbourhood& neighbourhood)
    : data_(data),
      tree_(tree),
      plain_(neighbourhood.plain()),
      limit_(neighbourhood.neighbours > 0 ? static_cast<std::size_t>(neighbourhood.neighbours)
                                          : data.local.size()),
      octant_limit_(neighbourhood.octants > 0 ? static_cast<std::size_t>(neighbourhood.octants)
                                              : data.local.size()),
      squared_radius_(neighbourhood.radius > 0 ? neighbourhood.radius * neighbourhood.radius
                                               : std::numeric_limits<double>::infinity()) {
    limit_ = std::min(limit_, 8 * std::min(octant_limit_, data.local.size()));
}

bool NeighbourSearch::find(const Place& place, std::vector<spatial::Neighbour>& found,
                           std::int32_t left_out) {
    if (plain_ && left_out == nobody) {
        tree_.find(place, limit_, found);
        return true;
    }
    const std::size_t most = looked_at * limit_ + 1;
    // Octants leave out many of the nearest; otherwise only the point left out is one too many.
    std::size_t count = (octant_limit_ < limit_ ? 2 * limit_ : limit_) + 1;
    while (true) {
        tree_.find(place, count, candidates_);
        const bool complete = choose(place, left_out, found);
        if (complete || count >= data_.local.size() || count >= most) break;
        count *= 2;
    }
    if (!found.empty()) return true;
    for (const spatial::Neighbour& candidate : candidates_) {
        if (candidate.point == left_out) continue;
        found.push_back(candidate);
        break;
    }
    return false;
}

/// Whether farther points could add nothing.
bool NeighbourSearch::choose(const Place& place, std::int32_t left_out,
                             std::vector<spatial::Neighbour>& found) {
    found.clear();
    std::array<std::size_t, 8> taken{};
    for (const spatial::Neighbour& candidate : candidates_) {
        if (candidate.point == left_out) continue;
        if (candidate.squared_distance > squared_radius_) return true;
        const Place& there = data_.local[static_cast<std::size_t>(candidate.point)];
        std::size_t& here = taken[octant(there[0] - place[0], there[1] - place[1])];
        if (here == octant_limit_) continue;
        ++here;
        found.push_back(candidate);
        if (found.size() == limit_) return true;
    }
    return false;
}

}  // namespace realmodel::interpolation
