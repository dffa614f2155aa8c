// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/joins.hpp"

#include "strata/repair/border_joining.hpp"
#include "strata/repair/plan_context.hpp"
#include "strata/repair/plan_snapping.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

struct Joins::State {
    PlanSnapping snapping;
    BorderChains chains;
    Warning warning;

    std::optional<JoinedMesh> mesh(const TriangleView& surface, std::size_t columns,
                                   const Execution& execution) const {
        begin_step(execution.progress, 0.0, 1.0, "joining the borders");
        JoinedMesh joined = joined_mesh({surface, columns}, snapping, chains, execution.progress);
        if (!is_single_valued({joined.vertices, joined.triangles}, columns, execution)) return {};
        return joined;
    }

private:
    // All meshes together are single-valued where each is alone: what a mesh covers is found from
    // its own border (load_input), and that the frame around this one is another one does not
    // count, as it only has to lie outside of the border (fill_frame).
    static bool is_single_valued(const TriangleView& mesh, std::size_t columns,
                                 const Execution& execution) {
        StackInput input;
        if (columns == 3) {
            input.surfaces.push_back(mesh);
        } else {
            input.region = mesh;
        }
        std::vector<Warning> warnings;
        return load_input({&input, 1}, {}, warnings, execution)->is_single_valued;
    }
};

const Warning& Joins::warning() const {
    return joining_->warning;
}

std::vector<double> Joins::snapped(std::span<const double> vertices, std::size_t columns) const {
    return joined_mesh({{vertices, {}}, columns}, joining_->snapping, {}).vertices;
}

std::optional<JoinedMesh> Joins::mesh(const TriangleView& mesh, std::size_t columns,
                                      const Execution& execution) const {
    return joining_->mesh(mesh, columns, execution);
}

std::optional<Joins> find_joins(std::span<const StackInput> rocks, bool borders,
                                const Execution& execution) {
    begin_step(execution.progress, 0.0, 1.0, "comparing the borders");
    const auto joining = std::make_shared<Joins::State>();
    joining->snapping = find_snapping(rocks, execution);
    if (borders) joining->chains = find_chains(rocks, joining->snapping, {1, execution.progress});
    if (joining->snapping.empty() && joining->chains.empty()) return {};
    joining->warning = joined_by_rounding(joining->snapping, joining->chains);
    return Joins(joining);
}

}  // namespace realmodel::strata
