// SPDX-License-Identifier: GPL-3.0-or-later
#include "block_layers.hpp"

#include <algorithm>
#include <cmath>

#include "block_overlay.hpp"
#include "parallel_counts.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;
using exact::SpaceId;
using exact::VertexId;

namespace {

/// So many triangles of a surface in a tile, on average. Fewer tell more apart and cost more.
constexpr std::size_t kTrianglesInTile = 1;

PlanBox box_of_edge(const PlanGeometry& geometry, VertexId from, VertexId to) {
    const auto &p = geometry.point(from), &q = geometry.point(to);
    return {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y)};
}

}  // namespace

BlockLayer make_block_layer(PlanGeometry& geometry, const std::vector<UsedTriangle>& triangles,
                            SurfacePlan plan, std::int32_t number, int threads,
                            const Progress* progress) {
    if (!plan.filling)
        make_layer(geometry, triangles, plan, {}, number, threads, progress);  // refuses
    BlockLayer layer;
    layer.number = number;
    layer.first_plane = make_planes(geometry, triangles, threads, progress);
    layer.neighbour = std::move(plan.links.neighbour);
    parallel_ranges(layer.size(), 8192, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                std::int32_t& n = layer.neighbour[t][i];
                if (n >= 0 && !meet_in_height(geometry, layer.first_plane + static_cast<PlaneId>(t),
                                              i, layer.first_plane + n))
                    n = -1;
            }
        }
    });
    for (std::size_t t = 0; t < plan.filling->triangles.size(); ++t) {
        if (plan.filling->covered[t] == 0) layer.empty.push_back(plan.filling->triangles[t]);
    }
    return layer;
}

BlockRegion make_block_region(const PlanGeometry& geometry,
                              const std::vector<PlanTriangle>& triangles, const Frame& frame,
                              const Progress* progress) {
    BlockRegion region;
    region.border = link_triangles(
                        triangles.size(), [&](std::size_t t) { return triangles[t]; }, progress)
                        .border;
    const FrameTriangles filling = fill_frame(geometry, region.border, frame);
    for (std::size_t t = 0; t < filling.triangles.size(); ++t)
        (filling.covered[t] == 0 ? region.outside : region.inside).push_back(filling.triangles[t]);
    return region;
}

BlockOverlay make_block_overlay(PlanGeometry& geometry, const std::vector<BlockLayer>& layers,
                                const std::optional<BlockRegion>& region, int threads,
                                const Progress* progress) {
    PlanBox frame{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double largest = 0;
    std::size_t triangles = 0;
    for (const BlockLayer& layer : layers) {
        triangles = std::max(triangles, layer.size());
        for (std::size_t t = 0; t < layer.size(); ++t) {
            poll(progress, t);
            const auto b = bounds_of(geometry, layer.first_plane + static_cast<PlaneId>(t));
            frame = {std::min(frame.low_x, b.box.low_x), std::min(frame.low_y, b.box.low_y),
                     std::max(frame.high_x, b.box.high_x), std::max(frame.high_y, b.box.high_y)};
            largest = std::max({largest, std::abs(b.low), std::abs(b.high)});
        }
    }
    const PlanTiles tiles(triangles > 0 ? frame : PlanBox{}, triangles / kTrianglesInTile);
    std::vector<std::uint8_t> on_border(tiles.size(), 0);
    const auto mark = [&](VertexId from, VertexId to) {
        tiles.for_each(tiles.span(box_of_edge(geometry, from, to)),
                       [&](std::size_t tile) { on_border[tile] = 1; });
    };
    for (const BlockLayer& layer : layers) {
        for (std::size_t t = 0; t < layer.size(); ++t) {
            poll(progress, t);
            const auto& corner = geometry.plane(layer.first_plane + static_cast<PlaneId>(t)).corner;
            for (std::size_t i = 0; i < 3; ++i) {
                if (layer.neighbour[t][i] < 0)
                    mark(geometry.space(corner[i]).plan, geometry.space(corner[(i + 1) % 3]).plan);
            }
        }
    }
    if (region) {
        for (const BorderEdge& edge : region->border)
            mark(edge.low, edge.high);
    }
    BlockOverlay overlay(geometry, layers, tiles, std::move(on_border), largest, threads, progress);
    if (region) overlay.start_region(region->inside, region->outside);
    return overlay;
}

}  // namespace realmodel::strata
