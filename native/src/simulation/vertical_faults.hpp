// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/complex.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::simulation {

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
    struct Face {
        std::int32_t number;
        std::array<PlanPoint, 2> line;
    };
    bool reaches(const Face& face, double share, double height, double rounding) const;

    ComplexView model_;
    std::span<const std::array<PlanPoint, 2>> steps_;
    std::vector<Face> faces_;
    spatial::BoxTree face_tree_, step_tree_;
};

}  // namespace realmodel::simulation
