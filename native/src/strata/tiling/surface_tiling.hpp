// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/strata/stack.hpp"
#include "strata/tiling/plan_grid.hpp"
#include "strata/tiling/plan_links.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// Planes that are none: where a tiling has no surface, what lies above all surfaces, and what lies
/// outside the region.
inline constexpr PlaneId kVoid{-1};
inline constexpr PlaneId kSky{-2};
inline constexpr PlaneId kOutside{-3};

/// Heights between which a triangle lies.
struct HeightRange {
    double low, high;
};
HeightRange heights_of(const exact::PlanArrangement& geometry, PlaneId plane);

/// One surface as a set of convex plan polygons that tile the whole frame: its triangles, and void
/// triangles where it has none. So every plan point lies in one polygon of every tiling, and
/// cutting away what a surface does not cover needs no operation of its own.
struct SurfaceTiling {
    PolygonPool polygons;
    std::vector<PlaneId> plane;  ///< of each polygon, kVoid where there is no surface
    /// Of each polygon: 1 where the surface is known to go on at the same heights across all of its
    /// edges, with one polygon beyond each.
    std::vector<std::uint8_t> runs_on;
    /// Of each polygon, where they are known: across each edge of a triangle between vertices the
    /// one there, or -1.
    std::vector<std::array<std::int32_t, 3>> neighbor;
    Array<HeightRange> heights;  ///< of each polygon's plane, where it has one
    PlanGrid grid;

    /// Makes the grid of the polygons as they are now, and finds their heights; nothing more is
    /// known of how they run on.
    void index(const exact::PlanArrangement& geometry, const Execution& execution,
               std::size_t cells = 0);
    /// Links triangles that are not linked yet.
    void link(const exact::PlanArrangement& geometry, Progress* progress);
};

/// The tiling of a surface, and the surface's number.
struct NumberedTiling {
    const SurfaceTiling& tiling;
    std::int32_t number;
};

/// A triangle of the input as it is used: its number there and its plan vertices.
struct UsedTriangle {
    std::int64_t number;
    std::array<exact::SpaceId, 3> corner;  ///< counter-clockwise in plan
};

/// Its plan vertices.
PlanTriangle plan_of(const exact::PlanArrangement& geometry, const UsedTriangle& triangle);

/// A checked surface, and how its triangles are connected in plan.
struct EnteredSurface {
    std::vector<UsedTriangle> triangles;
    PlanLinks links;
};

/// A triangle that turns counter-clockwise as a polygon; its lines are made where they are new.
std::array<Corner, 3> triangle_outline(exact::PlanArrangement& geometry, const PlanTriangle& v);

/// Whether two triangles meet along edge i of the first at the same heights.
bool meet_in_height(const exact::PlanArrangement& geometry, PlaneId plane, std::size_t i,
                    PlaneId other);

/// How a surface lies in plan.
struct SurfacePlan {
    PlanLinks links;
    /// The frame around its triangles; nothing where they cover a position twice.
    std::optional<FrameTriangles> filling;
};

/// How checked surfaces lie in plan; their links are taken.
std::vector<SurfacePlan> plan_surfaces(const exact::PlanArrangement& geometry,
                                       std::vector<EnteredSurface>& surfaces, const Frame& frame,
                                       const Execution& execution);

/// Planes of triangles, one after another; the first of them.
PlaneId make_planes(exact::PlanArrangement& geometry, const std::vector<UsedTriangle>& triangles,
                    const Execution& execution);

/// The tiling of a checked surface, whose plan is taken. `similar`: outlines that some of the
/// triangles may have at the same numbers, whose lines are then known.
/// @throws InputError kind double_valued, with the two triangles and a position in both
SurfaceTiling make_surface_tiling(exact::PlanArrangement& geometry,
                                  const std::vector<UsedTriangle>& triangles, SurfacePlan plan,
                                  const PolygonPool& similar, int index,
                                  const Execution& execution);

/// The region as a tiling: plane kSky inside and kOutside outside.
SurfaceTiling make_region_tiling(exact::PlanArrangement& geometry,
                                 const std::vector<PlanTriangle>& triangles,
                                 const FrameTriangles& filling);

}  // namespace realmodel::strata
