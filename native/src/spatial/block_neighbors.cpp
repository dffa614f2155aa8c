// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/block_neighbors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/index.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::spatial {

namespace {

constexpr double kWidest = 0.3;   // radius of a block, in distances to the last point wanted
constexpr std::size_t kMost = 4;  // candidates for each point wanted

}  // namespace

bool BlockNeighbors::prepare(std::span<const PlanPosition> nodes) {
    const PlanBox box = box_around(nodes);
    const PlanPosition center{0.5 * (box.low_x + box.high_x), 0.5 * (box.low_y + box.high_y)};
    tree_.find(center, count_, found_);
    if (nodes.size() > 1) {
        const double wanted = std::sqrt(found_.back().squared_distance);
        const double radius = elementary::hypot(box.high_x - center[0], box.high_y - center[1]);
        if (radius > kWidest * wanted) return false;
        // The nearest of a node lie within wanted + radius of it.
        const double reach = (wanted + 2 * radius) * (1 + 1e-9);
        if (!tree_.within(center, reach, kMost * count_, found_)) return false;
    }
    candidates_.clear();
    for (const Neighbor& neighbor : found_)
        candidates_.push_back(neighbor.point);
    std::sort(candidates_.begin(), candidates_.end());
    x_.clear();
    y_.clear();
    for (const std::int32_t point : candidates_) {
        const auto [x, y] = tree_.point(point);
        x_.push_back(x);
        y_.push_back(y);
    }
    squared_.resize(candidates_.size());
    keys_.resize(count_);
    order_.resize(candidates_.size());
    std::iota(order_.begin(), order_.end(), 0);
    return true;
}

std::span<const std::int32_t> BlockNeighbors::nearest(const PlanPosition& node) {
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

}  // namespace realmodel::spatial
