// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "interpolation/kriging/estimate.hpp"
#include "interpolation/kriging/lane_kernels.hpp"
#include "interpolation/linear_data.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"
#include "realmodel/interpolation/drift.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// Numbers aligned to a cache line, all zero.
class AlignedNumbers {
public:
    explicit AlignedNumbers(std::size_t count = 0) : numbers_(count + 8) {}
    double* data() {
        const auto address = reinterpret_cast<std::uintptr_t>(numbers_.data());
        return numbers_.data() + ((64 - address % 64) % 64) / sizeof(double);
    }

private:
    std::vector<double> numbers_;
};

/// Kriging of many nodes from a few data each: takes nodes that lie close together, block by
/// block, and solves their systems side by side. One for each thread. Without a drift the estimates
/// are, to the last bit, those of NeighborKriging; with one, systems that are not well posed are
/// left to it.
class LaneKriging {
public:
    static constexpr std::size_t kMostNeighbors = kMostLanePoints;

    struct KrigingNode {
        PlanPosition position;                            ///< in local coordinates
        std::uint32_t number;                             ///< given back with the estimate
        std::int32_t left_out = NeighborSearch::kNobody;  ///< a point that is not used
    };

    /// @param neighbors   points of each system, from 1; with two slopes of each dip at a node at
    ///                    most kMostNeighbors
    /// @param leaves_out  nodes may leave out a point: there is one more in the data
    LaneKriging(const LinearData& data, const spatial::NearestPoints& tree,
                const Covariance& covariance, std::size_t neighbors, bool leaves_out,
                const LaneKernels& kernels, Drift drift = Drift::kConstant);

    /// Solves the systems of some nodes; set(number, estimate) gets each estimate, in any order.
    /// leave(number) gets nodes whose system is not well posed; never without a drift.
    template <class Set, class Leave>
    void krige(std::span<const KrigingNode> nodes, Set&& set, Leave&& leave);

private:
    static constexpr std::size_t kMostInBlock = 64;

    bool prepare(std::span<const PlanPosition> nodes);
    void find_candidates();
    void prepare_covariances();
    bool add(const KrigingNode& node);
    void covariances_with_nodes(double* covariances);
    void set_drift(double* terms);
    void solve();
    template <class Set, class Leave>
    void flush(Set&& set, Leave&& leave);

    const LinearData& data_;
    Covariance covariance_;
    const LaneKernels& kernels_;
    std::size_t points_, slopes_, count_;  // of a system; data in all
    std::size_t ends_;                     // positions whose heights these are
    spatial::BlockNeighbors block_;
    std::optional<spatial::BlockNeighbors> dip_block_;
    std::size_t run_ = kMostInBlock;  // nodes tried as a block next
    std::vector<PlanPosition> positions_;
    std::vector<std::int32_t> candidates_;  // data: points, then slopes
    std::size_t point_candidates_ = 0;
    std::vector<PlanPosition> ends_of_candidates_;
    std::vector<double> table_;  // covariances of all candidates with each other
    std::size_t pair_count_ = 0;
    AlignedNumbers pair_x_, pair_y_, pair_covariance_;
    Drift drift_;
    std::size_t terms_;
    AlignedNumbers rows_, node_x_, node_y_, with_ends_, estimates_, variances_, well_posed_;
    std::vector<double> scales_;             // of the slopes of a system, in all lanes
    std::span<const std::int32_t> nearest_;  // points of the node at hand
    std::size_t filled_ = 0;                 // kLanes
    std::uint32_t number_[kLanes] = {};
    double base_[kLanes] = {};
};

template <class Set, class Leave>
void LaneKriging::krige(std::span<const KrigingNode> nodes, Set&& set, Leave&& leave) {
    while (!nodes.empty()) {
        std::size_t count = std::min(run_, nodes.size());
        positions_.clear();
        for (std::size_t i = 0; i < count; ++i)
            positions_.push_back(nodes[i].position);
        while (!prepare({positions_.data(), count}))
            count /= 2;
        run_ = std::min(2 * count, kMostInBlock);
        prepare_covariances();
        for (const KrigingNode& node : nodes.first(count)) {
            nearest_ = block_.nearest(node.position);
            if (node.left_out == NeighborSearch::kNobody && block_.squared_distance(0) == 0) {
                const std::int32_t point = block_.candidates()[nearest_[0]];
                set(node.number, Estimate{data_.points().values[point], 0});
            } else if (add(node)) {
                flush(set, leave);
            }
        }
        nodes = nodes.subspan(count);
    }
    if (filled_ > 0) flush(set, leave);
}

template <class Set, class Leave>
void LaneKriging::flush(Set&& set, Leave&& leave) {
    solve();
    for (std::size_t lane = 0; lane < filled_; ++lane) {
        if (drift_ != Drift::kConstant && well_posed_.data()[lane] == 0) {
            leave(number_[lane]);
            continue;
        }
        set(number_[lane],
            Estimate{base_[lane] + estimates_.data()[lane], variances_.data()[lane]});
    }
    filled_ = 0;
}

}  // namespace realmodel::interpolation
