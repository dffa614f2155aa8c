// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/column_fronts.hpp"
#include "simulation/post_levels.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

/// Columns between levels. Corners of elements and faces are numbers of heights (counted as
/// PostLevels::node_offset does), so the mesh has no points yet.
struct FilledColumns {
    LayeredMesh mesh;
    ColumnFronts fronts;
    /// An upright face on a step; the columns on both sides may have it.
    struct StepFace {
        std::array<std::int32_t, 4> key, corners;  ///< of a triangle the last is -1; key: sorted
        std::size_t number;
        std::array<PlanPoint, 2> edge;
        double height;  ///< of its center
        std::int32_t surface;
    };
    std::vector<StepFace> step_faces;
};

/// Fills the columns of all triangles from the bottom up. A front, one height at each corner, moves
/// up step by step; what lies between two fronts is an element. All three corners move by one
/// height each: a prism; two: a pyramid; one: a tetrahedron.
/// @throws InputError kind too_large
FilledColumns fill_columns(const ColumnInput& input, const PostLevels& levels, Progress* progress);

/// Faces on steps that only one side has belong to the outside; of those that both have only those
/// on faults are faces of the mesh.
void add_step_faces(FilledColumns& columns, const VerticalFaults& faults);

}  // namespace realmodel::simulation
