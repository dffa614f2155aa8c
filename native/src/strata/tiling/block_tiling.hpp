// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

class BlockOverlay;

/// A surface while blocks are built: its triangles span the planes from `first_plane` on.
struct BlockTiling {
    std::int32_t number = 0;
    PlaneId first_plane = 0;
    /// Across edge i, from corner i to corner i + 1, the only other triangle there, at the same
    /// heights; -1 where a wall may stand.
    std::vector<std::array<std::int32_t, 3>> neighbour;
    std::vector<PlanTriangle> empty;  ///< where in the frame the surface is not
    std::size_t size() const { return neighbour.size(); }
    bool has(PlaneId plane) const {
        return plane >= first_plane && plane < first_plane + static_cast<PlaneId>(size());
    }
};

/// The region in triangles, and what lies around it.
struct BlockRegion {
    std::vector<PlanTriangle> inside, outside;
    std::vector<BorderEdge> border;
};

/// The layer of a checked surface from its linked triangles; its planes are made.
/// @throws InputError kind double_valued, as make_surface_tiling does
BlockTiling make_block_tiling(exact::PlanArrangement& geometry,
                              const std::vector<UsedTriangle>& triangles, SurfacePlan plan,
                              std::int32_t number, int threads, const Progress* progress);

BlockRegion make_block_region(const exact::PlanArrangement& geometry,
                              const std::vector<PlanTriangle>& triangles, const Frame& frame,
                              const Progress* progress);

/// An overlay of these layers (oldest first; they must outlive it) under the sky over the region.
BlockOverlay make_block_overlay(exact::PlanArrangement& geometry,
                                const std::vector<BlockTiling>& layers,
                                const std::optional<BlockRegion>& region, int threads,
                                const Progress* progress);

}  // namespace realmodel::strata
