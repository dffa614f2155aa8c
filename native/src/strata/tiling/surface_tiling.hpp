// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "realmodel/base/array.hpp"
#include "realmodel/strata/stack.hpp"
#include "spatial/box_tree.hpp"
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
/// Around a polygon in the plane of a triangle: as high as the triangle is.
spatial::Box box_of(LocalArrangement& scope, PolygonView polygon, PlaneId plane);

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

/// A triangle that turns counter-clockwise as a polygon; its lines are made where they are new.
std::array<Corner, 3> triangle_outline(exact::PlanArrangement& geometry, const PlanTriangle& v);

/// Where no outline is known that an edge could be taken from.
inline constexpr std::int32_t kNoOutline = -1;

/// Adds the outlines of triangles; their lines are made where they are new. Edges are fetched some
/// triangles before they are needed.
/// @param plan_of  plan_of(i) is the i-th triangle
/// @param earlier  earlier(i, e) is which of the triangles before the i-th has edge e the other way
///     around, or kNoOutline
template <class PlanOf, class Earlier>
void add_outlines(exact::PlanArrangement& geometry, std::size_t count, const PlanOf& plan_of,
                  const Earlier& earlier, PolygonPool& pool, Progress* progress) {
    constexpr std::size_t kAhead = 8;
    const std::size_t polygons = pool.size(), corners = pool.corners.size();
    pool.corners.resize(corners + 3 * count);
    pool.offsets.resize(polygons + count + 1);
    const auto outline = [&](std::size_t i) { return &pool.corners[corners + 3 * i]; };
    for (std::size_t i = 0; i < count; ++i) {
        poll(progress, i);
        const PlanTriangle v = plan_of(i);
        const PlanTriangle ahead = plan_of(std::min(i + kAhead, count - 1));
        for (std::size_t e = 0; e < 3; ++e) {
            const std::size_t next = (e + 1) % 3;
            if (i + kAhead < count && earlier(i + kAhead, e) == kNoOutline)
                geometry.prefetch_edge(ahead[e], ahead[next]);
            Corner& corner = outline(i)[e];
            corner.point = v[e];
            const std::int32_t before = earlier(i, e);
            if (before == kNoOutline) {
                corner.line = geometry.add_edge(v[e], v[next]);
                continue;
            }
            assert(static_cast<std::size_t>(before) < i);
            const Corner* other = outline(static_cast<std::size_t>(before));
            while (other->point != v[next])
                ++other;
            corner.line = other->line.reversed();
        }
        pool.offsets[polygons + i + 1] = static_cast<std::uint32_t>(corners + 3 * (i + 1));
    }
}

/// The same where nothing is known of the triangles' neighbors.
template <class PlanOf>
void add_outlines(exact::PlanArrangement& geometry, std::size_t count, const PlanOf& plan_of,
                  PolygonPool& pool, Progress* progress) {
    add_outlines(
        geometry, count, plan_of, [](std::size_t, std::size_t) { return kNoOutline; }, pool,
        progress);
}

/// Whether two triangles meet along edge i of the first at the same heights.
bool meet_in_height(const exact::PlanArrangement& geometry, PlaneId plane, std::size_t i,
                    PlaneId other);

/// How a surface lies in plan.
struct SurfacePlan {
    PlanLinks links;
    /// The frame around its triangles; nothing where they cover a position twice.
    std::optional<FrameTriangles> filling;
};

SurfacePlan plan_surface(const exact::PlanArrangement& geometry,
                         const std::vector<UsedTriangle>& triangles, const Frame& frame,
                         Progress* progress);

/// Planes of triangles, one after another; the first of them.
PlaneId make_planes(exact::PlanArrangement& geometry, const std::vector<UsedTriangle>& triangles,
                    const Execution& execution);

/// The tiling of a checked surface, whose plan is taken.
/// @throws InputError kind double_valued, with the two triangles and a position in both
SurfaceTiling make_surface_tiling(exact::PlanArrangement& geometry,
                                  const std::vector<UsedTriangle>& triangles, SurfacePlan plan,
                                  int index, const Execution& execution);

/// The region as a tiling: plane kSky inside and kOutside outside.
SurfaceTiling make_region_tiling(exact::PlanArrangement& geometry,
                                 const std::vector<PlanTriangle>& triangles,
                                 const FrameTriangles& filling);

/// A surface while blocks are built, or what rules raised it to: triangles as a whole, and pieces
/// of triangles, which overlays always cut exactly.
struct BlockTiling {
    std::vector<PlaneId> whole;
    PolygonPool pieces;
    std::vector<PlaneId> piece_plane;  ///< kVoid where there is no surface
    std::vector<PlanTriangle> empty;   ///< where in the frame the surface is not
    bool is_raised = false;            ///< triangles of older surfaces may be among these

    /// Number of whole triangles and pieces, counted in this order.
    std::size_t size() const { return whole.size() + piece_plane.size(); }
    bool is_whole(std::size_t i) const { return i < whole.size(); }
    PlaneId plane(std::size_t i) const {
        return is_whole(i) ? whole[i] : piece_plane[i - whole.size()];
    }
    void add_piece(PolygonView outline, PlaneId in_plane) {
        pieces.add(outline);
        piece_plane.push_back(in_plane);
    }
};

/// How the triangles of surfaces are connected in space.
struct TriangleLinks {
    /// Of each plane: across edge i, from corner i to corner i + 1, the only other triangle of its
    /// surface there, at the same heights; -1 where a wall may stand.
    std::vector<std::array<PlaneId, 3>> neighbor;
    /// The edges across which there is none, and borders of regions.
    std::vector<std::pair<exact::VertexId, exact::VertexId>> border;

    const std::array<PlaneId, 3>& of(PlaneId plane) const { return neighbor[index(plane)]; }
};

/// A checked surface from its linked triangles; its planes are made, and their links added.
/// @throws InputError kind double_valued, as make_surface_tiling does
BlockTiling make_block_tiling(exact::PlanArrangement& geometry,
                              const std::vector<UsedTriangle>& triangles, SurfacePlan plan,
                              std::int32_t number, TriangleLinks& links,
                              const Execution& execution);

}  // namespace realmodel::strata
