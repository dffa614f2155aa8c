// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spatial/nearest_points.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// Finds the nearest points of nodes that lie close together: one search of the tree for a block of
/// nodes; then each node finds its own among the candidates,
/// as NearestPoints::find does. One for each thread.
class BlockNeighbors {
public:
    /// @param count  points wanted at each node; there are as many
    BlockNeighbors(const NearestPoints& tree, std::size_t count) : tree_(tree), count_(count) {}

    /// Finds the candidates of a block; false where it is too wide for that to pay: halve it. A
    /// single node is never too wide.
    bool prepare(std::span<const PlanPosition> nodes);

    /// Numbers of the points that may be near a node of the block, ascending.
    std::span<const std::int32_t> candidates() const { return candidates_; }

    /// The nearest to a node of the block, nearest first, as numbers of candidates; what is said of
    /// one node holds until the next is asked for.
    std::span<const std::int32_t> nearest(const PlanPosition& node);

    /// Of the k-th of `nearest`.
    double squared_distance(std::size_t k) const { return keys_[k]; }

private:
    const NearestPoints& tree_;
    std::size_t count_;
    std::vector<Neighbor> found_;
    std::vector<std::int32_t> candidates_, order_;
    std::vector<double> x_, y_, squared_, keys_;
};

}  // namespace realmodel::spatial
