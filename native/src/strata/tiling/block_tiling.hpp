// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// A surface while blocks are built, or what rules raised it to: triangles as a whole, and parts of
/// triangles, which overlays always cut exactly.
struct BlockTiling {
    std::vector<PlaneId> whole;
    PolygonPool parts;
    std::vector<PlaneId> part_plane;  ///< kVoid where there is no surface
    std::vector<PlanTriangle> empty;  ///< where in the frame the surface is not
    bool is_raised = false;           ///< triangles of older surfaces may be among these

    /// Number of whole triangles and parts, counted in this order.
    std::size_t size() const { return whole.size() + part_plane.size(); }
    bool is_whole(std::size_t i) const { return i < whole.size(); }
    PlaneId plane(std::size_t i) const {
        return is_whole(i) ? whole[i] : part_plane[i - whole.size()];
    }
    void add_part(PolygonView outline, PlaneId in_plane) {
        parts.add(outline);
        part_plane.push_back(in_plane);
    }
};

/// How the triangles of surfaces are connected in space.
struct TriangleLinks {
    /// Of each plane: across edge i, from corner i to corner i + 1, the only other triangle of its
    /// surface there, at the same heights; -1 where a wall may stand.
    std::vector<std::array<PlaneId, 3>> neighbor;
    /// The edges across which there is none, and borders of regions.
    std::vector<std::pair<exact::VertexId, exact::VertexId>> border;

    bool has(PlaneId plane) const { return index(plane) < neighbor.size(); }
    const std::array<PlaneId, 3>& of(PlaneId plane) const { return neighbor[index(plane)]; }
};

/// A checked surface from its linked triangles; its planes are made, and their links added.
/// @throws InputError kind double_valued, as make_surface_tiling does
BlockTiling make_block_tiling(exact::PlanArrangement& geometry,
                              const std::vector<UsedTriangle>& triangles, SurfacePlan plan,
                              std::int32_t number, TriangleLinks& links,
                              const Execution& execution);

}  // namespace realmodel::strata
