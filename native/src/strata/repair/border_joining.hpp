// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/strata/joins.hpp"
#include "realmodel/strata/stack.hpp"
#include "spatial/plan_tiles.hpp"
#include "strata/repair/plan_snapping.hpp"

namespace realmodel::strata {

/// Edges of borders that are to be divided, the lesser end first, with the vertices that divide
/// them, from that end on.
using BorderChains = std::map<std::pair<spatial::PlanPosition, spatial::PlanPosition>,
                              std::vector<spatial::PlanPosition>>;

/// The edges that have to be divided so that borders run through each other's vertices.
///
/// Meshes of one outline with different edge lengths have their border vertices at different
/// positions of its straight edges, each off the line by a unit in the last place: slivers of
/// rounding size would lie all along the border. So every edge that borders a surface or a region
/// is divided at the border vertices that lie within rounding of it (in every mesh that has this
/// edge), and the triangles at it with the edge; the borders then coincide exactly. Where all
/// vertices lie exactly on the line nothing is divided. Passes over what the builder refuses later.
/// @param threads  as many meshes are looked at at once
/// @throws Cancelled
BorderChains find_chains(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                         const Execution& execution = {});

/// A mesh with snapped coordinates, its edges divided, but for those of a triangle of which a part
/// would turn over. The numbers of triangles that were not divided stay; the first piece of a
/// divided one has its number, the others come after all. Passes over what the builder refuses
/// later.
/// @throws Cancelled
JoinedMesh joined_mesh(const PlanMesh& mesh, const PlanSnapping& snapping,
                       const BorderChains& chains, Progress* progress = nullptr);

/// Input with its edges divided.
struct JoinedBorders {
    std::vector<StackInput> rocks;  ///< views of the meshes below
    std::deque<JoinedMesh> meshes;

    JoinedBorders() = default;
    JoinedBorders(JoinedBorders&&) = default;
    JoinedBorders& operator=(JoinedBorders&&) = default;
    JoinedBorders(const JoinedBorders&) = delete;
    JoinedBorders& operator=(const JoinedBorders&) = delete;
};

/// joined_mesh of all meshes.
/// @throws Cancelled
JoinedBorders join_borders(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                           const BorderChains& chains, Progress* progress = nullptr);

/// What is done to the input before it is built.
Warning joined_by_rounding(const PlanSnapping& snapping, const BorderChains& chains);

}  // namespace realmodel::strata
