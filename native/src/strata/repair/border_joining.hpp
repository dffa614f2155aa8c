// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "realmodel/strata/stack.hpp"
#include "strata/repair/plan_snapping.hpp"

namespace realmodel::strata {

/// Input whose borders run through each other's vertices.
///
/// Meshes of one outline with different edge lengths have their border vertices at different
/// positions of its straight edges, each off the line by a unit in the last place: slivers of
/// rounding size would lie all along the border. So every edge that borders a surface or a region
/// is divided at the border vertices that lie within rounding of it (in every mesh that has this
/// edge), and the triangles at it with the edge; the borders then coincide exactly. Where all
/// vertices lie exactly on the line nothing is divided, and no triangle is where one of its parts
/// would turn over.
struct JoinedBorders {
    std::vector<StackInput> rocks;  ///< views of the meshes below; all coordinates snapped
    std::deque<std::vector<double>> vertices;
    std::deque<std::vector<std::int32_t>> triangles;
    std::size_t divided = 0;  ///< edges; 0: nothing to join, all else is empty

    JoinedBorders() = default;
    JoinedBorders(JoinedBorders&&) = default;
    JoinedBorders& operator=(JoinedBorders&&) = default;
    JoinedBorders(const JoinedBorders&) = delete;
    JoinedBorders& operator=(const JoinedBorders&) = delete;
};

/// The numbers of triangles that were not divided stay; the first part of a divided one has its
/// number, the others come after all. Passes over what the builder refuses later.
/// @throws Cancelled
JoinedBorders join_borders(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                           int threads = 1, const Progress* progress = nullptr);

/// What was done to the input before it was built.
Warning joined_by_rounding(const PlanSnapping& snapping, const JoinedBorders& borders);

}  // namespace realmodel::strata
