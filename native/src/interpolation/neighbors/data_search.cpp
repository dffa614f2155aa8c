// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbors/data_search.hpp"

namespace realmodel::interpolation {

bool DataSearch::find(const Position& position, std::vector<spatial::Neighbor>& found,
                      std::int32_t left_out) {
    const bool near = points_.find(position, found, left_out);
    if (data_.dip_count() == 0 || found.empty()) return near;
    data_.dip_tree().find(position, data_.dips_at_node(), dips_);
    for (const spatial::Neighbor& dip : dips_) {
        if (dip.squared_distance > squared_radius_) break;
        const std::int32_t first = data_.first_of_dip(dip.point);
        found.push_back({dip.squared_distance, first});
        found.push_back({dip.squared_distance, first + 1});
    }
    return near;
}

}  // namespace realmodel::interpolation
