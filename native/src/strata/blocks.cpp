// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "base/parallel_counts.hpp"
#include "strata/build.hpp"
#include "strata/cells/block_cells.hpp"
#include "strata/cells/cell_building.hpp"
#include "strata/overlay/block_envelope.hpp"
#include "strata/overlay/rock_regions.hpp"
#include "strata/overlay/rules.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

namespace {

/// So many triangles of a surface in a tile, on average. Fewer sort more and cost more.
constexpr std::size_t kTrianglesInTile = 1;

/// The surfaces of all rock masses, and how their triangles are connected.
struct Surfaces {
    TriangleLinks links;
    std::vector<std::vector<BlockTiling>> of_rock;  ///< oldest first
    std::vector<Envelope> in_window;                ///< of the rock masses that have a window
    PlanBox box = spatial::kNoBox;
    double largest_height = 0;
    std::size_t tiles = 1;

    void measure(const exact::PlanArrangement& geometry, const Execution& execution);
};

/// Finds the box and heights of all triangles, and how many tiles are right for them: those of the
/// largest surface of each rock mass.
void Surfaces::measure(const exact::PlanArrangement& geometry, const Execution& execution) {
    constexpr std::size_t kTriangles = 8192;
    struct TriangleExtent {
        PlanBox box = spatial::kNoBox;
        double largest_height = 0;
    };
    std::size_t triangles = 0;
    for (const auto& tilings : of_rock) {
        std::size_t largest = 0;
        for (const BlockTiling& tiling : tilings) {
            largest = std::max(largest, tiling.whole.size());
            std::vector<TriangleExtent> extents((tiling.whole.size() + kTriangles - 1) /
                                                kTriangles);
            parallel_ranges(tiling.whole.size(), kTriangles, execution,
                            [&](std::size_t begin, std::size_t end) {
                                TriangleExtent& extent = extents[begin / kTriangles];
                                for (std::size_t t = begin; t < end; ++t) {
                                    const auto b = bounds_of(geometry, tiling.whole[t]);
                                    extent.box = extent.box.united(b.box);
                                    extent.largest_height = std::max(
                                        {extent.largest_height, std::abs(b.low), std::abs(b.high)});
                                }
                            });
            for (const TriangleExtent& extent : extents) {
                box = box.united(extent.box);
                largest_height = std::max(largest_height, extent.largest_height);
            }
        }
        triangles += largest;
    }
    if (triangles == 0) box = {};
    tiles = triangles / kTrianglesInTile;
}

Surfaces make_surfaces(PlanContext& context, const Execution& execution) {
    Surfaces surfaces;
    for (LoadedRock& rock : context.rocks) {
        auto& tilings = surfaces.of_rock.emplace_back();
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            if (execution.progress != nullptr) execution.progress->check();
            const auto number = rock.first_surface + static_cast<std::int32_t>(k);
            tilings.push_back(make_block_tiling(context.geometry, rock.surfaces[k],
                                                std::move(rock.plans[k]), number, surfaces.links,
                                                execution));
            context.surface_of_plane.resize(context.geometry.plane_count(), number);
            rock.surfaces[k] = std::vector<UsedTriangle>();  // without its memory
        }
        for (const BorderEdge& edge : rock.region_border)
            surfaces.links.border.emplace_back(edge.low, edge.high);
        for (const BorderEdge& edge : rock.window_plan.links.border)
            surfaces.links.border.emplace_back(edge.low, edge.high);
        if (rock.window) surfaces.in_window.push_back(region_envelope(context, rock, execution));
    }
    surfaces.links.neighbor.resize(context.geometry.plane_count(), {kNone, kNone, kNone});
    surfaces.measure(context.geometry, execution);
    return surfaces;
}

/// Turns the surfaces of a rock mass to what its rules leave of them.
void replay_rules(PlanContext& context, const LoadedRock& rock, const Surfaces& surfaces,
                  const BorderEdges& borders, std::vector<BlockTiling>& tilings,
                  const Execution& execution) {
    RuleReplay replay(BlockRaising(context.geometry, borders, surfaces.largest_height, execution),
                      rock.rules);
    for (BlockTiling& tiling : tilings) {
        if (execution.progress != nullptr) execution.progress->check();
        tiling = replay.add(std::move(tiling));
    }
}

}  // namespace

BuiltCells build_blocks(PlanContext& context, const Execution& execution) {
    Surfaces surfaces = make_surfaces(context, execution);
    const BorderEdges borders(context.geometry, PlanTiles(surfaces.box, surfaces.tiles),
                              std::move(surfaces.links.border));
    Construction construction;
    WholeTriangles wholes(context.geometry.plane_count());
    RockFootprints footprints;
    double start = kInputDone;
    std::size_t window = 0;
    for (std::size_t r = 0; r < context.rocks.size(); ++r) {
        LoadedRock& rock = context.rocks[r];
        std::vector<BlockTiling>& tilings = surfaces.of_rock[r];
        const double share = (kOverlayDone - kInputDone) / std::max(context.surfaces, 1);
        const std::size_t first_node = construction.node_block.size(),
                          first_face = construction.faces.size();
        if (!rock.is_erosional())
            replay_rules(context, rock, surfaces, borders, tilings, execution);
        BlockEnvelope envelope(context.geometry, surfaces.links, borders, surfaces.largest_height,
                               construction, wholes, execution);
        if (rock.window) {
            envelope.start_window(rock.region_filling, rock.window_plan.filling.value(),
                                  std::move(surfaces.in_window[window++]));
        } else if (rock.region) {
            envelope.start_region(rock.region_filling);
        }
        for (std::size_t k = tilings.size(); k-- > 0;) {
            begin_step(execution.progress, start, share, "intersecting the surfaces");
            envelope.add(tilings[k], static_cast<std::int32_t>(k));
            tilings[k] = {};
            start += share;
        }
        if (rock.base) check_base(rock, envelope.lowest());
        envelope.finish(rock.base);
        construction.count_blocks_from(first_node, rock.first_surface);
        add_touched_triangles(context.geometry, surfaces.links, wholes, construction.faces,
                              execution);
        if (context.rocks.size() > 1)
            footprints.add(context.geometry, construction.faces, first_face, execution.progress);
    }
    const BlockLinks links{surfaces.links, wholes, borders};
    return build_cells(context.geometry, construction, &links, context.surface_of_plane,
                       context.window, execution);
}

}  // namespace realmodel::strata
