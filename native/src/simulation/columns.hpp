// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of elements: filled, and repaired.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/progress.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/pillar_levels.hpp"
#include "simulation/plan_topology.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::simulation {

/// Of each corner of a triangle: a height of its node.
using LevelFront = std::array<std::int32_t, 3>;

/// The elements over all triangles of a planar mesh: each lies between two fronts, one after the
/// other.
struct ColumnFronts {
    std::vector<std::size_t> offset{0};  ///< of the first front of each triangle, and the end
    std::vector<LevelFront> fronts;      ///< upward; none where nothing stands
    std::vector<std::int32_t> blocks;    ///< of what lies above each; -1 above the last

    /// How many elements stand on a triangle. Element e has the number offset[t] + e, and so has
    /// the front below it.
    std::size_t elements(std::size_t t) const {
        const std::size_t front_count = offset[t + 1] - offset[t];
        return front_count == 0 ? 0 : front_count - 1;
    }
};

/// The faces of a model on vertical faults, to be found beside the simplified steps of a mesh.
class VerticalFaults {
public:
    /// @param steps  all steps of the model in plan
    VerticalFaults(const ComplexView& model, std::span<const std::array<PlanPoint, 2>> steps);

    bool empty() const { return faces_.empty(); }
    /// The fault that a face of the mesh lies on: it stands on an edge in plan, and its center has
    /// this height. kWall where the step of the model that is nearest to the middle of the edge is
    /// of no fault, or the fault does not reach this height there.
    std::int32_t fault_at(const PlanPoint& from, const PlanPoint& to, double height) const;

private:
    /// A vertical face: from where to where it goes in plan.
    struct VerticalFace {
        std::int32_t number;
        std::array<PlanPoint, 2> line;
    };
    bool reaches(const VerticalFace& face, double share, double height, double rounding) const;

    ComplexView model_;
    std::span<const std::array<PlanPoint, 2>> steps_;
    std::vector<VerticalFace> faces_;
    spatial::BoxTree face_tree_, step_tree_;
};

/// Columns between levels. Corners of elements and faces are numbers of heights (counted as
/// PillarLevels::node_offset does), so the mesh has no points yet.
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
FilledColumns fill_columns(const ColumnInput& input, const PillarLevels& levels,
                           Progress* progress);

/// Faces on steps that only one side has belong to the outside; of those that both have only those
/// on faults are faces of the mesh.
void add_step_faces(FilledColumns& columns, const VerticalFaults& faults);

/// Where columns of one element may be given up, 1 or 0 for each triangle. Solvers call such
/// elements under-determined; but where the model is one element thick over a wide area, or
/// everywhere, giving them up at its border would only make their neighbors the border, until
/// nothing is left of them. So they may go where they form strips no wider than a few triangles
/// beside columns of more elements.
std::vector<std::uint8_t> narrow_strips(const PlanTopology& plan, const ColumnFronts& columns);

/// Columns whose levels change until solvers can compute on the elements between them.
/// @throws InputError kind too_large
LayeredMesh repaired_columns(const ColumnInput& input, const VerticalFaults& faults,
                             const Layering& layering, Progress* progress);

}  // namespace realmodel::simulation
