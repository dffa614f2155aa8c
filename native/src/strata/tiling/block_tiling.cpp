// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/block_tiling.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel_counts.hpp"
#include "strata/overlay/block_overlay.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::SpaceId;
using exact::VertexId;

namespace {

/// So many triangles of a surface in a tile, on average. Fewer tell more apart and cost more.
constexpr std::size_t kTrianglesInTile = 1;

PlanBox around(const PlanBox& a, const PlanBox& b) {
    return {std::min(a.low_x, b.low_x), std::min(a.low_y, b.low_y), std::max(a.high_x, b.high_x),
            std::max(a.high_y, b.high_y)};
}

}  // namespace

BlockTiling make_block_tiling(PlanArrangement& geometry, const std::vector<UsedTriangle>& triangles,
                              SurfacePlan plan, std::int32_t number, int threads,
                              const Progress* progress) {
    if (!plan.filling)
        make_surface_tiling(geometry, triangles, plan, {}, number, threads, progress);  // refuses
    BlockTiling layer;
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

BlockRegion make_block_region(const PlanArrangement& geometry,
                              const std::vector<PlanTriangle>& triangles, const Frame& frame,
                              const Progress* progress) {
    BlockRegion region;
    region.border = link_triangles(triangles, progress).border;
    const FrameTriangles filling = fill_frame(geometry, region.border, frame);
    for (std::size_t t = 0; t < filling.triangles.size(); ++t)
        (filling.covered[t] == 0 ? region.outside : region.inside).push_back(filling.triangles[t]);
    return region;
}

BlockOverlay make_block_overlay(PlanArrangement& geometry, const std::vector<BlockTiling>& layers,
                                const std::optional<BlockRegion>& region, int threads,
                                const Progress* progress) {
    struct Extent {
        PlanBox frame{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        double largest_height = 0;
        std::vector<BorderEdges::Edge> border;
    };
    std::vector<Extent> extents(layers.size());
    parallel_chunks(layers.size(), threads, progress, [&](std::size_t k) {
        const BlockTiling& layer = layers[k];
        auto& [frame, largest, border] = extents[k];
        for (std::size_t t = 0; t < layer.size(); ++t) {
            const PlaneId plane = layer.first_plane + static_cast<PlaneId>(t);
            const auto b = bounds_of(geometry, plane);
            frame = around(frame, b.box);
            largest = std::max({largest, std::abs(b.low), std::abs(b.high)});
            const auto& corner = geometry.plane(plane).plan;
            for (std::size_t i = 0; i < 3; ++i) {
                if (layer.neighbour[t][i] < 0) border.emplace_back(corner[i], corner[(i + 1) % 3]);
            }
        }
    });
    PlanBox frame = Extent{}.frame;
    double largest = 0;
    std::size_t triangles = 0;
    std::vector<BorderEdges::Edge> edges;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        frame = around(frame, extents[k].frame);
        largest = std::max(largest, extents[k].largest_height);
        triangles = std::max(triangles, layers[k].size());
        edges.insert(edges.end(), extents[k].border.begin(), extents[k].border.end());
    }
    const PlanTiles tiles(triangles > 0 ? frame : PlanBox{}, triangles / kTrianglesInTile);
    if (region) {
        for (const BorderEdge& edge : region->border)
            edges.emplace_back(edge.low, edge.high);
    }
    BlockOverlay overlay(geometry, layers, BorderEdges(geometry, tiles, std::move(edges)), largest,
                         threads, progress);
    if (region) overlay.start_region(region->inside, region->outside);
    return overlay;
}

}  // namespace realmodel::strata
