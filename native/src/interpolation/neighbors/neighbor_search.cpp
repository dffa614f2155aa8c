// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbors/neighbor_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kLookedAt = 64;      // times the points wanted, until octants may stay empty
constexpr std::size_t kMostInOrder = 256;  // more are found faster by rings than by the tree

}  // namespace

void check_neighborhood(const Neighborhood& neighborhood) {
    if (neighborhood.neighbors < 0) {
        throw InputError("option", "the number of neighbors is negative; 0 means all points");
    }
    if (neighborhood.octants < 0) {
        throw InputError("option", "the number of points in an octant is negative; 0 means any");
    }
    if (!(neighborhood.radius >= 0) || !std::isfinite(neighborhood.radius)) {
        throw InputError("option", "the radius is negative or infinite; 0 means no limit");
    }
}

void require_memory(double bytes, double points, const char* what, int fewer) {
    const double room = 0.9 * static_cast<double>(available_memory());
    if (bytes <= room) return;
    char text[300];
    std::snprintf(text, sizeof text,
                  "%s %.0f points would take %.3g GB; there are %.3g GB: use fewer neighbors, e.g. "
                  "neighbours = %d",
                  what, points, bytes / 1e9, room / 1e9, fewer);
    throw InputError("too_large", text);
}

NeighborSearch::NeighborSearch(const DataPoints& data, const spatial::NearestPoints& tree,
                               const Neighborhood& neighborhood)
    : tree_(tree),
      plain_(neighborhood.plain()),
      limit_(neighborhood.neighbors > 0 ? static_cast<std::size_t>(neighborhood.neighbors)
                                        : data.local.size()),
      octant_limit_(neighborhood.octants > 0 ? static_cast<std::size_t>(neighborhood.octants)
                                             : data.local.size()),
      squared_radius_(neighborhood.radius > 0 ? neighborhood.radius * neighborhood.radius
                                              : std::numeric_limits<double>::infinity()) {
    limit_ = std::min(limit_, 8 * std::min(octant_limit_, data.local.size()));
    const bool by_octants = octant_limit_ < limit_;
    if (by_octants || (neighborhood.radius > 0 && limit_ > kMostInOrder)) {
        const std::size_t count = by_octants ? kLookedAt * limit_ + 1 : data.local.size();
        rings_.emplace(data.local, spatial::OctantSearch::Wanted{octant_limit_, limit_, count,
                                                                 squared_radius_});
    }
}

bool NeighborSearch::find(const PlanPosition& position, std::vector<spatial::Neighbor>& neighbors,
                          std::int32_t left_out) {
    if (plain_ && left_out == kNobody) {
        tree_.find(position, limit_, neighbors);
        return true;
    }
    if (rings_) {
        rings_->find(position, left_out, neighbors);
    } else {
        tree_.find(position, limit_ + 1, candidates_);  // the one left out is one too many
        neighbors.clear();
        for (const spatial::Neighbor& candidate : candidates_) {
            if (candidate.squared_distance > squared_radius_ || neighbors.size() == limit_) break;
            if (candidate.point != left_out) neighbors.push_back(candidate);
        }
    }
    if (!neighbors.empty()) return true;
    tree_.find(position, 2, candidates_);
    for (const spatial::Neighbor& candidate : candidates_) {
        if (candidate.point == left_out) continue;
        neighbors.push_back(candidate);
        break;
    }
    return false;
}

bool DataSearch::find(const PlanPosition& position, std::vector<spatial::Neighbor>& neighbors,
                      std::int32_t left_out) {
    const bool near = points_.find(position, neighbors, left_out);
    if (data_.dip_count() == 0 || neighbors.empty()) return near;
    data_.dip_tree().find(position, data_.dips_at_node(), dips_);
    for (const spatial::Neighbor& dip : dips_) {
        if (dip.squared_distance > squared_radius_) break;
        const std::int32_t first = data_.first_of_dip(dip.point);
        neighbors.push_back({dip.squared_distance, first});
        neighbors.push_back({dip.squared_distance, first + 1});
    }
    return near;
}

}  // namespace realmodel::interpolation
