// SPDX-License-Identifier: GPL-3.0-or-later
// Delaunay refinement of a triangulated region.
#pragma once

#include <cstddef>
#include <span>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

struct RefinementTarget {
    double least_angle;    ///< radians; asked of every angle not given by two fixed edges
    double longest_edge;   ///< times the length wanted; a triangle with a longer one is refined
    double shortest_edge;  ///< nothing is refined where edges are as short as this already
    std::size_t most_vertices;  ///< beyond it InputError "too_large"
};

/// Adds vertices until triangles meet the target (Ruppert 1995 with the lenses of Shewchuk 2002,
/// "Delaunay refinement algorithms for triangular mesh generation", section 3.4: a fixed edge is
/// cut where a new vertex would come too near to it, or would lie twin it). Fixed edges are only
/// ever cut in two. Triangles before `first`, but for those in `also`, are taken to be good.
/// Deterministic; `check` is called often.
void refine(FlatMesh& mesh, const RefinementTarget& target, SizeField& size, std::int32_t first,
            std::span<const std::int32_t> also, const Check& check);

/// Fills triangles larger than `size` wants with vertices, from the border and from what is small
/// enough inwards: each vertex makes a triangle of the wanted size with an edge that has such a
/// triangle or the border twin it (frontal Delaunay: Rebay 1993, "Efficient unstructured mesh
/// generation by means of Delaunay triangulation and Bowyer-Watson algorithm"). Fixed edges are
/// left whole. Triangles before `first` are taken to be small enough.
void advance_front(FlatMesh& mesh, SizeField& size, std::int32_t first, std::size_t most_vertices,
                   const Check& check);

/// Refuses a mesh that has grown beyond what there is room for.
void require_room(const FlatMesh& mesh, std::size_t most_vertices);

}  // namespace realmodel::meshing
