// SPDX-License-Identifier: GPL-3.0-or-later
// Delaunay refinement of a triangulated region. Private.
#pragma once

#include <cstddef>
#include <vector>

#include "meshing/constrained_delaunay.hpp"

namespace realmodel::meshing {

struct RefinementTarget {
    double least_angle;         ///< radians; asked of every angle not given by two border edges
    double longest_edge;        ///< a triangle with a longer edge is refined too
    double shortest_edge;       ///< nothing is refined where edges are as short as this already
    std::size_t most_vertices;  ///< of the whole triangulation; beyond it InputError "too_large"
};

/// Adds vertices to the faces in the domain until they meet the target (Ruppert 1995 with the
/// lenses of Shewchuk 2002, "Delaunay refinement algorithms for triangular mesh generation",
/// section 3.4: a border edge is cut where a new vertex would come too near to it, or would lie
/// behind it). Constrained edges are the border and are only ever cut in two; they must not be on
/// the hull. New vertices are numbered on from `first_number`.
/// Deterministic; `check` is called often.
void refine(Cdt& cdt, const RefinementTarget& target, std::int32_t first_number,
            const Check& check);

}  // namespace realmodel::meshing
