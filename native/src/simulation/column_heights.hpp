// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/algorithms.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/meshing/triangulation.hpp"
#include "simulation/plan_topology.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::simulation {

using meshing::PlanPoint;

inline PlanPoint plan_of(const ComplexView& model, std::int32_t vertex) {
    const auto p = model.vertex(vertex);
    return {p[0], p[1]};
}

/// Lines in plan, to be found by their boxes.
inline spatial::BoxTree tree_in_plan(std::span<const std::array<PlanPoint, 2>> lines) {
    return spatial::BoxTree(
        transformed(lines, [](const auto& line) { return spatial::bounding_box(line); }));
}

/// Which blocks a rock mass has: those from first[rock] to first[rock + 1], oldest first.
struct RockBlocks {
    std::vector<std::int32_t> first;
    std::vector<std::int32_t> rock;  ///< of each block

    /// @throws InputError kind bad_index where blocks of one rock mass do not stand together
    explicit RockBlocks(std::span<const std::int32_t> block_rock);
    std::size_t count() const { return first.size() - 1; }
    std::int32_t blocks_of(std::int32_t of_rock) const;
    /// Of the rock mass that has most.
    std::int32_t most() const;
};

/// Whether a face has no area in plan, but for rounding.
bool is_vertical(const ComplexView& model, std::size_t face);
/// Of a face that has: whether its first cell lies below.
bool faces_up(const ComplexView& model, std::size_t face);

/// What a model has on vertical lines. Level i of a point is the top of block i - 1 of its rock
/// mass, level 0 the bottom; where a block is absent two levels are equal.
class ColumnHeights {
public:
    static constexpr std::int32_t kOutside = -1;
    static constexpr std::int32_t kIncomplete = -2;  ///< rounding leaves no whole column here

    ColumnHeights(const ComplexView& model, const RockBlocks& blocks,
                  std::span<const PlanPoint> points, const Execution& execution);

    std::size_t size() const { return rock_.size(); }
    std::int32_t rock(std::size_t point) const { return rock_[point]; }
    std::span<const double> levels(std::size_t point) const {
        return {&height_[point * stride_], stride_};
    }
    /// The surfaces that the levels lie on, or kBase.
    std::span<const std::int32_t> surfaces(std::size_t point) const {
        return {&surface_[point * stride_], stride_};
    }
    std::size_t stride() const { return stride_; }
    /// Takes the column of another point, of this or of other heights.
    void copy(std::size_t to, const ColumnHeights& other, std::size_t from);

private:
    std::size_t stride_;
    std::vector<std::int32_t> rock_;
    std::vector<double> height_;
    std::vector<std::int32_t> surface_;
};

/// What the model has at each pillar. A pillar beside a step or at the border takes the heights
/// nearest to its node that are on its own side of the steps of the model: lines were simplified,
/// so the node itself may lie beyond one. Of a pillar without any its rock is -1.
ColumnHeights pillar_columns(const ComplexView& model, const RockBlocks& blocks,
                             const PlanLines& lines, const PlanTopology& plan,
                             const Execution& execution);

}  // namespace realmodel::simulation
