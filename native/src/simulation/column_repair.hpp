// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/column_filler.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/element_quality.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_levels.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

/// Columns whose levels change until solvers can compute on the elements between them.
///
/// Elements are never edited. A step asks ElementQuality what is wrong, changes PostLevels (a
/// height is given up, or moves), and fills all columns anew. run() is the list of the steps.
class ColumnRepair {
public:
    /// @throws InputError kind too_large
    ColumnRepair(const PlanTopology& plan, const PlanLines& lines, const RockBlocks& blocks,
                 const ColumnHeights& heights, const Layering& layering, Progress* progress);

    void run();
    /// Faces on steps, and points of those heights that elements have.
    LayeredMesh finish(const VerticalFaults& faults);

private:
    /// Columns between the levels as they are now.
    struct Filling {
        LayeredMesh mesh;
        ColumnFiller filler;
        ElementQuality quality;
        Filling(LayeredMesh&& empty, const ColumnRepair& of);
    };

    void refill();
    void remove_weak_ends();
    void ease_steep_faces(double reach);
    void repair_failing();
    void join_skewed();
    bool changes_much(const std::vector<double>& volumes) const;

    const PlanTopology& plan_;
    const RockBlocks& blocks_;
    const ColumnHeights& heights_;
    const Layering& layering_;
    Progress* progress_;
    PostLevels levels_;
    std::optional<Filling> filling_;
    std::vector<std::uint8_t> is_narrow_;      ///< of each triangle, before the first repair
    std::vector<std::uint8_t> has_flat_base_;  ///< of each node
};

}  // namespace realmodel::simulation
