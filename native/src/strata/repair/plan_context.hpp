// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "strata/repair/plan_snapping.hpp"
#include "strata/tiling/plan_grid.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// A rock mass whose vertices are loaded.
struct LoadedRock {
    std::int32_t number = 0;
    std::int32_t first_surface = 0;  ///< counted through all rock masses
    std::vector<std::vector<UsedTriangle>> surfaces;
    std::vector<SurfacePlan> plans;  ///< of the surfaces
    std::vector<Rule> rules;
    std::vector<std::size_t> emptied;  ///< surfaces before which all that is there becomes air
    std::vector<std::uint8_t> fills;   ///< of those before the last of them: 1 for tops of bodies
    std::optional<std::vector<PlanTriangle>> region;
    std::vector<BorderEdge> region_border;
    FrameTriangles region_filling;                    ///< the frame around the region
    std::optional<std::vector<UsedTriangle>> window;  ///< two triangles at height 0
    SurfacePlan window_plan;
    std::optional<double> base_elevation;
    std::optional<PlaneId> base;  ///< a plane over the frame

    bool is_erosional() const;
};

/// What all rock masses share while they are built.
struct PlanContext {
    exact::PlanArrangement geometry;
    Frame frame;  ///< corners of a box that lies well outside of all input, and vertices between
    std::vector<LoadedRock> rocks;
    std::vector<std::int32_t> surface_of_plane;  ///< kBase for the flat bases
    std::int32_t surfaces = 0;                   ///< in all rock masses
    std::optional<Window> window;                ///< of a tile, or nothing
    std::optional<WantedBoxes> wanted;           ///< of columns, or all of them are
    bool is_local = false;  ///< of columns: edges have all vertices that lie on them
    /// Whether no surface and no region covers a position twice.
    bool is_single_valued = true;

    /// @throws InputError kind bad_region (items: the rock mass), where the border of a region
    /// crosses itself, or its triangles overlap
    void check_regions() const;
    bool is_empty() const { return geometry.point_count() == 0; }
};

/// Checks a surface and adds its vertices; leaves out triangles without area (with a warning).
/// @param index  the number of the surface
/// @throws InputError kinds not_finite, bad_index, vertical_triangle
std::vector<UsedTriangle> load_surface(exact::PlanArrangement& geometry,
                                       const TriangleView& surface, int index,
                                       const PlanSnapping& snapping, std::vector<Warning>& warnings,
                                       const Execution& execution);

/// Checks and loads the input: its vertices, a frame around them and flat bases; and finds how
/// each surface lies in the frame.
/// @throws InputError kinds not_finite, bad_index, vertical_triangle
std::unique_ptr<PlanContext> load_input(std::span<const StackInput> rocks,
                                        const PlanSnapping& snapping,
                                        std::vector<Warning>& warnings, const Execution& execution);

/// @throws InputError kind base_not_below (items: the rock mass), where the lowest position of a
/// rock mass is not above its base
void check_base(const LoadedRock& rock, const std::array<double, 3>& lowest);

}  // namespace realmodel::strata
