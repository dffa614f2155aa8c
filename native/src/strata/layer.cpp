// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "parallel_chunks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;
using exact::VertexId;

namespace {

void add_triangle(PlanGeometry& geometry, PolygonPool& pool, const PlanTriangle& triangle) {
    pool.add(triangle_outline(geometry, triangle));
}

PlanTriangle plan_of(const PlanGeometry& geometry, const UsedTriangle& triangle) {
    PlanTriangle v;
    for (std::size_t i = 0; i < 3; ++i)
        v[i] = geometry.space(triangle.corner[i]).plan;
    return v;
}

/// Void triangles (plane `empty`) where nothing is covered.
void add_empty(PlanGeometry& geometry, Layer& layer, const FrameTriangles& filling, PlaneId empty) {
    for (std::size_t t = 0; t < filling.triangles.size(); ++t) {
        if (filling.covered[t] != 0) continue;
        add_triangle(geometry, layer.polygons, filling.triangles[t]);
        layer.plane.push_back(empty);
    }
}

[[noreturn]] void refuse_pair(Scope& scope, const Layer& layer,
                              const std::vector<UsedTriangle>& triangles, std::size_t one,
                              std::size_t other, int index) {
    Clipper clipper(scope);
    const PolygonView common = clipper.intersect(layer.polygons[one], layer.polygons[other]);
    std::array<double, 3> place{0, 0, 0};
    const auto share = 1.0 / static_cast<double>(common.size());
    for (const Corner& corner : common) {
        const auto& p = scope.point(corner.point);
        place[0] += p.x * share;
        place[1] += p.y * share;
        place[2] += scope.rounded_height(layer.plane[one], corner.point) * share;
    }
    throw InputError("double_valued",
                     "triangles " + std::to_string(triangles[one].number) + " and " +
                         std::to_string(triangles[other].number) +
                         " overlap in plan: the surface has two heights there",
                     index, {triangles[one].number, triangles[other].number}, place);
}

/// Names the first two triangles that overlap; to be called where there are some.
[[noreturn]] void refuse_overlap(const PlanGeometry& geometry, const Layer& layer,
                                 const std::vector<UsedTriangle>& triangles, int index, int threads,
                                 const Progress* progress) {
    constexpr std::size_t kChunk = 1024;
    parallel_chunks(
        (triangles.size() + kChunk - 1) / kChunk, threads, progress, [&](std::size_t chunk) {
            Scope scope(geometry);
            Clipper clipper(scope);
            std::vector<std::int32_t> candidates;
            const std::size_t end = std::min(triangles.size(), (chunk + 1) * kChunk);
            for (std::size_t t = chunk * kChunk; t < end; ++t) {
                layer.grid.candidates(scope, layer.polygons[t], candidates);
                for (const std::int32_t c : candidates) {
                    const auto other = static_cast<std::size_t>(c);
                    if (other > t && clipper.overlap(layer.polygons[t], layer.polygons[other])) {
                        refuse_pair(scope, layer, triangles, t, other, index);
                    }
                }
            }
        });
    throw std::logic_error("a surface covers a place twice, yet no two of its triangles overlap");
}

}  // namespace

std::array<Corner, 3> triangle_outline(PlanGeometry& geometry, const PlanTriangle& v) {
    return {{{v[0], geometry.add_edge(v[0], v[1])},
             {v[1], geometry.add_edge(v[1], v[2])},
             {v[2], geometry.add_edge(v[2], v[0])}}};
}

void Layer::index(const PlanGeometry& geometry, const Progress* progress, std::size_t cells) {
    const Scope scope(geometry);
    std::vector<std::uint8_t> is_surface(plane.size());
    std::transform(plane.begin(), plane.end(), is_surface.begin(),
                   [](PlaneId p) { return static_cast<std::uint8_t>(p == kVoid ? 0 : 1); });
    runs_on.assign(plane.size(), 0);
    grid = PlanGrid(scope, polygons, is_surface, cells, progress);
}

std::optional<FrameTriangles> cover_frame(const PlanGeometry& geometry,
                                          const std::vector<BorderEdge>& border,
                                          const Frame& frame) {
    try {
        FrameTriangles filling = fill_frame(geometry, border, frame);
        const auto [least, most] =
            std::minmax_element(filling.covered.begin(), filling.covered.end());
        if (*least < 0 || *most > 1) return std::nullopt;
        return filling;
    } catch (const InputError&) {
        return std::nullopt;  // the border crosses itself
    }
}

bool meet_in_height(const PlanGeometry& geometry, PlaneId plane, std::size_t i, PlaneId other) {
    const auto& corner = geometry.plane(plane).corner;
    for (const exact::SpaceId s : {corner[i], corner[(i + 1) % 3]}) {
        if (geometry.corner_above(other, geometry.space(s).plan) != s) return false;
    }
    return true;
}

PlanLinks link_triangles(const PlanGeometry& geometry, const std::vector<UsedTriangle>& triangles,
                         const Progress* progress) {
    return link_triangles(
        triangles.size(), [&](std::size_t t) { return plan_of(geometry, triangles[t]); }, progress);
}

Layer make_layer(PlanGeometry& geometry, const std::vector<UsedTriangle>& triangles,
                 const Frame& frame, int index, int threads, const Progress* progress) {
    Layer layer;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        poll(progress, t);
        add_triangle(geometry, layer.polygons, plan_of(geometry, triangles[t]));
        layer.plane.push_back(geometry.add_plane(triangles[t].corner));
    }
    const PlanLinks links = link_triangles(geometry, triangles, progress);
    const auto filling = cover_frame(geometry, links.border, frame);
    if (!filling) {
        layer.index(geometry, progress);
        refuse_overlap(geometry, layer, triangles, index, threads, progress);
    }
    add_empty(geometry, layer, *filling, kVoid);
    layer.index(geometry, progress);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        poll(progress, t);
        bool runs_on = true;
        for (std::size_t i = 0; i < 3 && runs_on; ++i) {
            const std::int32_t n = links.neighbour[t][i];
            runs_on = n >= 0 && meet_in_height(geometry, layer.plane[t], i,
                                               layer.plane[static_cast<std::size_t>(n)]);
        }
        layer.runs_on[t] = runs_on ? 1 : 0;
    }
    return layer;
}

Layer make_region(PlanGeometry& geometry, const std::vector<PlanTriangle>& triangles,
                  const Frame& frame, const Progress* progress) {
    Layer layer;
    for (const PlanTriangle& triangle : triangles) {
        add_triangle(geometry, layer.polygons, triangle);
        layer.plane.push_back(kSky);
    }
    const auto corners = [&](std::size_t t) { return triangles[t]; };
    const PlanLinks links = link_triangles(triangles.size(), corners, progress);
    add_empty(geometry, layer, fill_frame(geometry, links.border, frame), kOutside);
    return layer;
}

}  // namespace realmodel::strata
