// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/surface_tiling.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <optional>
#include <string>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

/// Void triangles (plane `empty`) where nothing is covered.
void add_empty(PlanArrangement& geometry, SurfaceTiling& tiling, const FrameTriangles& filling,
               PlaneId empty) {
    for (std::size_t t = 0; t < filling.triangles.size(); ++t) {
        if (filling.covered[t] != 0) continue;
        tiling.polygons.add(triangle_outline(geometry, filling.triangles[t]));
        tiling.plane.push_back(empty);
    }
}

[[noreturn]] void refuse_pair(LocalArrangement& scope, const SurfaceTiling& tiling,
                              const std::vector<UsedTriangle>& triangles, std::size_t one,
                              std::size_t other, int index) {
    Clipper clipper(scope);
    clipper.begin(tiling.polygons[one]);
    const PolygonView common = clipper.intersect(tiling.polygons[other]);
    std::array<double, 3> position{0, 0, 0};
    const auto share = 1.0 / static_cast<double>(common.size());
    for (const Corner& corner : common) {
        const auto& p = scope.point(corner.point);
        position[0] += p.x * share;
        position[1] += p.y * share;
        position[2] += scope.rounded_height(tiling.plane[one], corner.point) * share;
    }
    throw InputError("double_valued",
                     "triangles " + std::to_string(triangles[one].number) + " and " +
                         std::to_string(triangles[other].number) +
                         " overlap in plan: the surface has two heights there",
                     index, {triangles[one].number, triangles[other].number}, position);
}

/// Names the first two triangles that overlap; to be called where there are some.
[[noreturn]] void refuse_overlap(const PlanArrangement& geometry, const SurfaceTiling& tiling,
                                 const std::vector<UsedTriangle>& triangles, int index,
                                 const Execution& execution) {
    constexpr std::size_t kChunk = 1024;
    parallel_ranges(triangles.size(), kChunk, execution, [&](std::size_t begin, std::size_t end) {
        LocalArrangement scope(geometry);
        Clipper clipper(scope);
        Array<std::int32_t> candidates;
        for (std::size_t t = begin; t < end; ++t) {
            tiling.grid.candidates(scope, tiling.polygons[t], candidates);
            clipper.begin(tiling.polygons[t]);
            for (const std::int32_t c : candidates) {
                const auto other = static_cast<std::size_t>(c);
                if (other > t && clipper.overlaps(tiling.polygons[other])) {
                    refuse_pair(scope, tiling, triangles, t, other, index);
                }
            }
        }
    });
    throw InternalError("of a surface that covers a position twice two triangles overlap");
}

/// Where triangles that turn counter-clockwise lie in the frame; nothing where they cover a
/// position twice.
std::optional<FrameTriangles> cover_frame(const PlanArrangement& geometry,
                                          const std::vector<BorderEdge>& border,
                                          const Frame& frame) {
    auto filling = fill_frame(geometry, border, frame);
    if (!filling) return std::nullopt;
    const auto [least, most] =
        std::minmax_element(filling->covered.begin(), filling->covered.end());
    if (*least < 0 || *most > 1) return std::nullopt;
    return filling;
}

/// Whether neighbors have each other.
[[maybe_unused]] bool are_symmetric(const TriangleLinks& links, PlaneId first) {
    for (std::size_t p = index(first); p < links.neighbor.size(); ++p) {
        for (const PlaneId n : links.neighbor[p]) {
            if (n == kNone) continue;
            const auto& back = links.of(n);
            if (std::find(back.begin(), back.end(), static_cast<PlaneId>(p)) == back.end())
                return false;
        }
    }
    return true;
}

}  // namespace

PlanTriangle plan_of(const PlanArrangement& geometry, const UsedTriangle& triangle) {
    PlanTriangle v;
    for (std::size_t i = 0; i < 3; ++i)
        v[i] = geometry.space(triangle.corner[i]).plan;
    return v;
}

std::array<Corner, 3> triangle_outline(PlanArrangement& geometry, const PlanTriangle& v) {
    return {{{v[0], geometry.add_edge(v[0], v[1])},
             {v[1], geometry.add_edge(v[1], v[2])},
             {v[2], geometry.add_edge(v[2], v[0])}}};
}

HeightRange heights_of(const PlanArrangement& geometry, PlaneId plane) {
    const auto& corner = geometry.plane(plane).corner;
    const auto [low, high] = std::minmax(
        {geometry.space(corner[0]).z, geometry.space(corner[1]).z, geometry.space(corner[2]).z});
    return {low, high};
}

spatial::Box box_of(LocalArrangement& scope, PolygonView polygon, PlaneId plane) {
    spatial::Box box;
    const HeightRange heights = heights_of(scope.shared(), plane);
    for (const Corner& corner : polygon) {
        const auto [x, y] = scope.rounded(corner.point);
        box.include(spatial::Box::Position{x, y, heights.low});
        box.include(spatial::Box::Position{x, y, heights.high});
    }
    return box;
}

void SurfaceTiling::index(const PlanArrangement& geometry, const Execution& execution,
                          std::size_t cells) {
    std::vector<std::uint8_t> is_surface(plane.size());
    std::transform(plane.begin(), plane.end(), is_surface.begin(),
                   [](PlaneId p) { return static_cast<std::uint8_t>(p == kVoid ? 0 : 1); });
    runs_on.assign(plane.size(), 0);
    grid = PlanGrid(geometry, polygons, is_surface, cells, execution);
    heights = Array<HeightRange>(plane.size());
    parallel_for_each(plane.size(), execution, [&](std::size_t p) {
        heights[p] = !plane[p].has_value() ? HeightRange{} : heights_of(geometry, plane[p]);
    });
}

void SurfaceTiling::link(const PlanArrangement& geometry, Progress* progress) {
    std::vector<PlanTriangle> open;
    std::vector<std::int32_t> number;
    neighbor.resize(plane.size(), {-1, -1, -1});
    for (std::size_t p = 0; p < plane.size(); ++p) {
        const PolygonView at = polygons[p];
        if (at.size() != 3 || std::ranges::min(neighbor[p]) >= 0 ||
            !std::ranges::all_of(at, [&](const Corner& c) { return geometry.is_vertex(c.point); }))
            continue;
        open.push_back({geometry.vertex(at[0].point), geometry.vertex(at[1].point),
                        geometry.vertex(at[2].point)});
        number.push_back(static_cast<std::int32_t>(p));
    }
    const PlanLinks links = link_triangles(open, progress);
    for (std::size_t t = 0; t < open.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = links.neighbor[t][i];
            if (n >= 0)
                neighbor[static_cast<std::size_t>(number[t])][i] =
                    number[static_cast<std::size_t>(n)];
        }
    }
}

bool meet_in_height(const PlanArrangement& geometry, PlaneId plane, std::size_t i, PlaneId other) {
    const auto& corner = geometry.plane(plane).corner;
    for (const exact::SpaceId s : {corner[i], corner[(i + 1) % 3]}) {
        if (geometry.plane(other).above(geometry.space(s).plan) != s) return false;
    }
    return true;
}

SurfacePlan plan_surface(const PlanArrangement& geometry,
                         const std::vector<UsedTriangle>& triangles, const Frame& frame,
                         Progress* progress) {
    Array<PlanTriangle> corners(triangles.size());
    std::ranges::transform(triangles, corners.begin(), [&](const UsedTriangle& triangle) {
        return plan_of(geometry, triangle);
    });
    SurfacePlan plan{link_triangles({corners.begin(), corners.size()}, progress), {}};
    plan.filling = cover_frame(geometry, plan.links.border, frame);
    return plan;
}

PlaneId make_planes(PlanArrangement& geometry, const std::vector<UsedTriangle>& triangles,
                    const Execution& execution) {
    const PlaneId first = geometry.make_planes(triangles.size());
    parallel_for_each(triangles.size(), execution,
                      [&](std::size_t t) { geometry.set_plane(first + t, triangles[t].corner); });
    return first;
}

SurfaceTiling make_surface_tiling(PlanArrangement& geometry,
                                  const std::vector<UsedTriangle>& triangles, SurfacePlan plan,
                                  int index, const Execution& execution) {
    SurfaceTiling tiling;
    const PlaneId first = make_planes(geometry, triangles, execution);
    tiling.plane.resize(triangles.size());
    std::iota(tiling.plane.begin(), tiling.plane.end(), first);
    add_outlines(
        geometry, triangles.size(), [&](std::size_t t) { return plan_of(geometry, triangles[t]); },
        [&](std::size_t t, std::size_t i) {
            const std::int32_t n = plan.links.neighbor[t][i];
            return n >= 0 && static_cast<std::size_t>(n) < t ? n : kNoOutline;
        },
        tiling.polygons, execution.progress);
    if (!plan.filling) {
        tiling.index(geometry, execution);
        refuse_overlap(geometry, tiling, triangles, index, execution);
    }
    add_empty(geometry, tiling, *plan.filling, kVoid);
    tiling.neighbor = std::move(plan.links.neighbor);
    tiling.index(geometry, execution);
    tiling.link(geometry, execution.progress);
    parallel_for_each(triangles.size(), execution, [&](std::size_t t) {
        bool runs_on = true;
        for (std::size_t i = 0; i < 3 && runs_on; ++i) {
            const std::int32_t n = tiling.neighbor[t][i];
            runs_on = n >= 0 && static_cast<std::size_t>(n) < triangles.size() &&
                      meet_in_height(geometry, tiling.plane[t], i,
                                     tiling.plane[static_cast<std::size_t>(n)]);
        }
        tiling.runs_on[t] = runs_on ? 1 : 0;
    });
    return tiling;
}

SurfaceTiling make_region_tiling(PlanArrangement& geometry,
                                 const std::vector<PlanTriangle>& triangles,
                                 const FrameTriangles& filling) {
    SurfaceTiling tiling;
    for (const PlanTriangle& triangle : triangles) {
        tiling.polygons.add(triangle_outline(geometry, triangle));
        tiling.plane.push_back(kSky);
    }
    add_empty(geometry, tiling, filling, kOutside);
    return tiling;
}

BlockTiling make_block_tiling(PlanArrangement& geometry, const std::vector<UsedTriangle>& triangles,
                              SurfacePlan plan, std::int32_t number, TriangleLinks& links,
                              const Execution& execution) {
    if (!plan.filling)
        make_surface_tiling(geometry, triangles, plan, number, execution);  // refuses
    const PlaneId first = make_planes(geometry, triangles, execution);
    assert(plan.links.neighbor.size() == triangles.size());
    links.neighbor.resize(index(first), {kNone, kNone, kNone});  // planes of bases
    links.neighbor.resize(index(first) + triangles.size());
    BlockTiling tiling;
    tiling.whole.resize(triangles.size());
    std::iota(tiling.whole.begin(), tiling.whole.end(), first);
    const auto border = collect_items<std::pair<exact::VertexId, exact::VertexId>>(
        triangles.size(), execution, [&](std::size_t t, auto& edges) {
            const PlaneId plane = tiling.whole[t];
            const PlanTriangle& corner = geometry.plane(plane).plan;
            auto& neighbors = links.neighbor[index(plane)];
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t n = plan.links.neighbor[t][i];
                if (n >= 0 && meet_in_height(geometry, plane, i, first + n)) {
                    neighbors[i] = first + n;
                    continue;
                }
                neighbors[i] = kNone;
                edges.emplace_back(corner[i], corner[(i + 1) % 3]);
            }
        });
    assert(are_symmetric(links, first));
    links.border.insert(links.border.end(), border.begin(), border.end());
    for (std::size_t t = 0; t < plan.filling->triangles.size(); ++t) {
        if (plan.filling->covered[t] == 0) tiling.empty.push_back(plan.filling->triangles[t]);
    }
    return tiling;
}

}  // namespace realmodel::strata
