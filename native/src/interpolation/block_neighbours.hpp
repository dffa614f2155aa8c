// SPDX-License-Identifier: GPL-3.0-or-later
// The nearest points of nodes that lie close together. Private.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// One search of the tree for a block of nodes; then each node finds its own among the candidates,
/// as NearestPoints::find does. One for each thread.
class BlockNeighbours {
public:
    /// @param count  points wanted at each node; there are as many
    BlockNeighbours(const DataPoints& data, const spatial::NearestPoints& tree, std::size_t count)
        : data_(data), tree_(tree), count_(count) {}

    /// Finds the candidates of a block; false where it is too wide for that to pay: halve it. A
    /// single node is never too wide.
    bool prepare(std::span<const Place> nodes);

    /// Numbers of the points that may be near a node of the block, ascending.
    std::span<const std::int32_t> candidates() const { return candidates_; }

    /// The nearest to a node of the block, nearest first, as numbers of candidates; what is said of
    /// one node holds until the next is asked for.
    std::span<const std::int32_t> nearest(const Place& node);

    /// Of the k-th of `nearest`.
    double squared_distance(std::size_t k) const { return keys_[k]; }

private:
    const DataPoints& data_;
    const spatial::NearestPoints& tree_;
    std::size_t count_;
    std::vector<spatial::Neighbour> found_;
    std::vector<std::int32_t> candidates_, order_;
    std::vector<double> x_, y_, squared_, keys_;
};

}  // namespace realmodel::interpolation
