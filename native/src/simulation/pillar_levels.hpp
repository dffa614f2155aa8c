// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/column_heights.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {

/// What columns are made from.
struct ColumnInput {
    const PlanLines& lines;
    const RockBlocks& blocks;
    const PlanTopology& plan;
    const ColumnHeights& heights;  ///< of each pillar
};

/// The heights of all pillars once layers are divided and nothing thin is left. The pillars of a
/// node share its heights, which ascend by the minimum thickness at least. Level l of a pillar is
/// the bottom of layer l of its rock mass, counted upward through its blocks.
class PillarLevels {
public:
    /// @throws InputError kind too_large
    PillarLevels(const ColumnInput& input, const Layering& layering);

    /// How many layers a rock mass has, and the block of each.
    std::span<const std::int32_t> layer_blocks(std::int32_t rock) const {
        return layer_block_[static_cast<std::size_t>(rock)];
    }
    /// Which of its node's heights each level of a pillar is.
    std::span<const std::int32_t> levels(std::size_t pillar) const {
        return {&level_[offset_[pillar]], offset_[pillar + 1] - offset_[pillar]};
    }
    /// The blocks of a pillar below and above a height of its node; -1: none.
    std::array<std::int32_t, 2> blocks_at(std::size_t pillar, std::int32_t rock,
                                          std::int32_t height) const;
    /// Where these stand among the levels of all pillars.
    std::size_t level_offset(std::size_t pillar) const { return offset_[pillar]; }
    std::size_t level_count() const { return level_.size(); }
    std::span<const double> heights(std::int32_t node) const {
        const auto n = static_cast<std::size_t>(node);
        return {&height_[node_offset_[n]], node_offset_[n + 1] - node_offset_[n]};
    }
    std::size_t node_offset(std::size_t node) const { return node_offset_[node]; }
    std::size_t height_count() const { return height_.size(); }

    /// A height of a node that is given up; what has it takes the one below or above.
    struct Removal {
        std::int32_t node, height, into;
        auto operator<=>(const Removal&) const = default;
    };
    /// Removes heights, the first of each node, or `several` that have nothing to do with one
    /// another. @return how many
    std::size_t remove(const PlanTopology& plan, std::vector<Removal>& removals,
                       bool several = false);

    /// A height of a node that should rise by so much.
    struct Move {
        std::int32_t node, height;
        double by;
    };
    /// Moves heights by the means of what is asked, but no farther than `most` from where they
    /// were at first, and no nearer to others than `gap` or than they are. Flat bases stay.
    /// @param alone  whether other heights of the same node stay; else those above move likewise,
    ///   and those below in proportion
    /// @param is_moved  set for the nodes where a height moved  @return whether any did
    bool relax_heights(const std::vector<Move>& moves, double most, double gap, bool alone,
                       std::span<const std::uint8_t> has_flat_base,
                       std::span<std::uint8_t> is_moved);

private:
    friend class LevelBuilder;
    bool is_valid(const PlanTopology& plan) const;

    std::vector<std::vector<std::int32_t>> layer_block_;  ///< of each rock mass
    std::vector<std::size_t> offset_, node_offset_;
    std::vector<std::int32_t> level_;
    std::vector<double> height_, first_height_;  ///< as they are, and before relax_heights()
};

}  // namespace realmodel::simulation
