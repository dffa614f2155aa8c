// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/block_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace realmodel::interpolation {

namespace {

constexpr double widest = 0.3;      // radius of a block, in distances to the last point wanted
constexpr std::size_t at_most = 4;  // candidates for each point wanted

}  // namespace

bool BlockNeighbours::prepare(std::span<const Place> nodes) {
    Place low = nodes[0], high = nodes[0];
    for (const Place& node : nodes) {
        for (int axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], node[axis]);
            high[axis] = std::max(high[axis], node[axis]);
        }
    }
    const Place centre{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
    tree_.find(centre, count_, found_);
    if (nodes.size() > 1) {
        const double wanted = std::sqrt(found_.back().squared_distance);
        const double radius = std::hypot(high[0] - centre[0], high[1] - centre[1]);
        if (radius > widest * wanted) return false;
        // The nearest of a node lie within wanted + radius of it.
        const double reach = (wanted + 2 * radius) * (1 + 1e-9);
        if (!tree_.within(centre, reach, at_most * count_, found_)) return false;
    }
    candidates_.clear();
    for (const spatial::Neighbour& neighbour : found_)
        candidates_.push_back(neighbour.point);
    std::sort(candidates_.begin(), candidates_.end());
    x_.clear();
    y_.clear();
    for (const std::int32_t point : candidates_) {
        x_.push_back(data_.local[static_cast<std::size_t>(point)][0]);
        y_.push_back(data_.local[static_cast<std::size_t>(point)][1]);
    }
    squared_.resize(candidates_.size());
    keys_.resize(count_);
    order_.resize(candidates_.size());
    std::iota(order_.begin(), order_.end(), 0);
    return true;
}

std::span<const std::int32_t> BlockNeighbours::nearest(const Place& node) {
    const std::size_t count = candidates_.size();
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = node[0] - x_[i], dy = node[1] - y_[i];
        squared_[i] = dx * dx + dy * dy;
    }
    // Insertion into the order of the node before, which is nearly that of this one. Only the first
    // count_ are in order.
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t candidate = order_[i];
        const double key = squared_[static_cast<std::size_t>(candidate)];
        const auto after = [&](std::size_t k) {
            return keys_[k] > key || (keys_[k] == key && order_[k] > candidate);
        };
        std::size_t at = i;
        if (i >= count_) {
            if (!after(count_ - 1)) continue;
            at = count_ - 1;
            order_[i] = order_[at];
        }
        for (; at > 0 && after(at - 1); --at) {
            keys_[at] = keys_[at - 1];
            order_[at] = order_[at - 1];
        }
        keys_[at] = key;
        order_[at] = candidate;
    }
    return {order_.data(), count_};
}

}  // namespace realmodel::interpolation
