// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "strata/cells/volumes.hpp"
#include "strata/conform/conformed_faces.hpp"

namespace realmodel::strata {

/// How far plan vertices are from where they are exactly. Nothing where the model is so large for
/// its coordinates that its volumes do not depend on it.
Array<PlanOffset> find_plan_offsets(const exact::PlanArrangement& geometry,
                                    const PlanVertices& plan_vertices, const Execution& execution);

/// The same of vertices, some of which were moved.
Array<PlanOffset> vertex_offsets(const Array<PlanOffset>& offsets,
                                 const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                                 const Execution& execution);
/// Keeps those of vertices that have a new number.
void renumber(Array<PlanOffset>& offsets, const std::vector<std::int32_t>& number);

/// What a tile has on the four lines that bound it. Its neighbors have the same points there, so
/// nothing about them may depend on what else is in the tile.
struct TileBorder {
    /// A plan vertex whose rounded position is on a line of an axis, and whether it is there
    /// exactly.
    struct PlanVertex {
        PlanVertexId number;
        std::array<bool, 2> is_on;  ///< across which axis
    };

    Window window;
    std::vector<PlanVertex> plan_vertices;  ///< by number
    std::vector<BorderVertex> vertices;     ///< those of plan vertices exactly on a line

    /// Nothing of a plan vertex that is on no line even when rounded.
    const PlanVertex* find(PlanVertexId number) const;
    /// Whether a plan vertex may be given this position: on the lines that it is on, and strictly
    /// between the others.
    bool allows(std::size_t number, const PlanPosition& position) const;
    /// Keeps those vertices that have a new number.
    void renumber(const std::vector<std::int32_t>& number);
};

TileBorder find_tile_border(const exact::PlanArrangement& geometry, const FaceList& faces,
                            const PlanVertices& plan_vertices, const ConformedFaces& conformed,
                            const Window& window, const Execution& execution);

}  // namespace realmodel::strata
