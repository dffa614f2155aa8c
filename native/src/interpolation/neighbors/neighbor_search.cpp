// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbors/neighbor_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t looked_at = 64;       // times the points wanted, until octants may stay empty
constexpr std::size_t most_in_order = 256;  // that the tree finds in their order in good time

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
    : tree_(tree),
      plain_(neighbourhood.plain()),
      limit_(neighbourhood.neighbours > 0 ? static_cast<std::size_t>(neighbourhood.neighbours)
                                          : data.local.size()),
      octant_limit_(neighbourhood.octants > 0 ? static_cast<std::size_t>(neighbourhood.octants)
                                              : data.local.size()),
      squared_radius_(neighbourhood.radius > 0 ? neighbourhood.radius * neighbourhood.radius
                                               : std::numeric_limits<double>::infinity()) {
    limit_ = std::min(limit_, 8 * std::min(octant_limit_, data.local.size()));
    const bool by_octants = octant_limit_ < limit_;
    if (by_octants || (neighbourhood.radius > 0 && limit_ > most_in_order)) {
        const std::size_t count = by_octants ? looked_at * limit_ + 1 : data.local.size();
        rings_.emplace(data.local,
                       OctantSearch::Wanted{octant_limit_, limit_, count, squared_radius_});
    }
}

bool NeighbourSearch::find(const Place& place, std::vector<spatial::Neighbour>& found,
                           std::int32_t left_out) {
    if (plain_ && left_out == nobody) {
        tree_.find(place, limit_, found);
        return true;
    }
    if (rings_) {
        rings_->find(place, left_out, found);
    } else {
        tree_.find(place, limit_ + 1, candidates_);  // the one left out is one too many
        found.clear();
        for (const spatial::Neighbour& candidate : candidates_) {
            if (candidate.squared_distance > squared_radius_ || found.size() == limit_) break;
            if (candidate.point != left_out) found.push_back(candidate);
        }
    }
    if (!found.empty()) return true;
    tree_.find(place, 2, candidates_);
    for (const spatial::Neighbour& candidate : candidates_) {
        if (candidate.point == left_out) continue;
        found.push_back(candidate);
        break;
    }
    return false;
}

}  // namespace realmodel::interpolation
