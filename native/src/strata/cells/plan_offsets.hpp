// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/cells/built_cells.hpp"
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

}  // namespace realmodel::strata
