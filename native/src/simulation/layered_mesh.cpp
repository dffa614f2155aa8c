// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/layered_mesh.hpp"

#include <utility>

#include "base/index.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/column_repair.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_columns.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::int32_t kMostFreeLayers = 16;  ///< where no layers are asked for

}  // namespace

LayeredMesh layered_mesh(const ComplexView& model, std::span<const std::int32_t> block_rock,
                         const PlanLines& lines, meshing::PlanarMesh mesh, Layering layering,
                         const Execution& execution) {
    const RockBlocks blocks(block_rock);
    PlanTopology plan(lines, std::move(mesh));
    const ColumnHeights heights = post_columns(model, blocks, lines, plan, execution);
    const VerticalFaults faults(model, lines.steps);
    std::vector<std::uint8_t> is_free(layering.layers.size(), 0);
    for (std::size_t b = 0; b < is_free.size(); ++b) {
        if (layering.layers[b] != 0 || layering.layer_thickness > 0) continue;
        layering.layers[b] = 1;
        is_free[b] = 1;
    }
    for (;;) {
        LayeredMesh made =
            repaired_columns({lines, blocks, plan, heights}, faults, layering, execution.progress);
        // blocks that are too thick for their top or base get twice as many layers
        bool again = false;
        for (const std::int32_t block : made.skewed.tall) {
            if (is_free[index(block)] == 0 || layering.layers[index(block)] >= kMostFreeLayers)
                continue;
            layering.layers[index(block)] *= 2;
            again = true;
        }
        if (again) continue;
        made.block_layers = std::move(layering.layers);
        made.plan = plan.take_mesh();
        return made;
    }
}

}  // namespace realmodel::simulation
