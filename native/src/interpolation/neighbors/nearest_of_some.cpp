// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbors/nearest_of_some.hpp"

#include <algorithm>
#include <limits>

#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

std::vector<spatial::Neighbor> nearest_of_some(const DistinctPoints& positions,
                                               std::span<const std::int32_t> asked,
                                               std::size_t count, const Execution& execution,
                                               std::size_t most) {
    count = std::min(count, positions.size);
    std::vector<spatial::Neighbor> nearest(asked.size() * count,
                                           {std::numeric_limits<double>::infinity(), 0});
    std::vector<PlanPosition> subset;
    for (std::size_t first = 0; first < positions.size; first += most) {
        if (execution.progress != nullptr) execution.progress->check();
        subset.clear();
        for (std::size_t i = first; i < std::min(first + most, positions.size); ++i)
            subset.push_back(positions.at(i));
        const spatial::NearestPoints tree(subset);
        const NodeLoop loop{asked.size(), 64, {execution.threads, nullptr}};
        loop.over_nodes([] { return std::vector<spatial::Neighbor>(); },
                        [&](std::vector<spatial::Neighbor>& near, std::size_t k) {
                            tree.find(positions.at(static_cast<std::size_t>(asked[k])), count,
                                      near);
                            for (spatial::Neighbor& neighbor : near)
                                neighbor.point += static_cast<std::int32_t>(first);
                            const auto before = nearest.begin() + k * count;
                            const auto middle = near.insert(near.end(), before, before + count);
                            std::inplace_merge(near.begin(), middle, near.end());
                            std::copy_n(near.begin(), count, before);
                        });
    }
    return nearest;
}

}  // namespace realmodel::interpolation
