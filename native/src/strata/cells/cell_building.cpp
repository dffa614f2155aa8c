// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/cell_building.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <string>
#include <utility>

#include "realmodel/base/errors.hpp"
#include "strata/cells/assembly.hpp"
#include "strata/cells/block_cells.hpp"
#include "strata/cells/distinct_positions.hpp"
#include "strata/cells/exact_positions.hpp"
#include "strata/conform/collinear_edges.hpp"
#include "strata/conform/walls.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

namespace {

/// Faces that conform, and what stands between them.
struct Conformed {
    PlanVertices plan_vertices;
    ConformedFaces conformed;
    WallLists walls;
    std::vector<ExtraPoint> crossings;  ///< of columns along lines
    double done = 0;                    ///< of the work
};

/// Two are enough (docs/dev/algorithm.md, "Why two rounds are enough"): beyond this many the
/// argument or the code is wrong.
constexpr int kMostRounds = 8;

/// Repeats the steps until no two columns cross in height between the vertices of a line.
Conformed conform(exact::PlanArrangement& geometry, Construction& construction,
                  const BlockLinks* blocks, const Execution& execution) {
    FaceList& faces = construction.faces;
    Conformed c;
    c.done = kOverlayDone;
    for (int round = 0; round < kMostRounds; ++round) {
        const auto next = [&](double of_round, const char* text) {
            // a second round, where there is one, shares what is left
            const double share = of_round * (1.0 - kOverlayDone) * (round == 0 ? 0.5 : 0.25);
            begin_step(execution.progress, c.done, share, text);
            c.done += share;
        };
        next(0.2, "joining points");
        c.plan_vertices = find_plan_vertices(geometry, faces, c.crossings, execution);
        next(0.4, "joining edges");
        CollinearEdges lines = find_collinear_edges(
            geometry, faces, c.plan_vertices, c.crossings,
            blocks == nullptr && !construction.is_local ? &construction.node_is_thick : nullptr,
            execution);
        next(0.3, "rounding");
        c.conformed = conform_faces(geometry, faces, c.plan_vertices, lines, execution,
                                    blocks == nullptr ? &faces.polygons.points : nullptr);
        next(0.1, "building walls");
        std::optional<BlockLines> of_blocks;
        if (blocks != nullptr)
            of_blocks.emplace(
                BlockLines{construction.node_block, c.plan_vertices, blocks->borders});
        c.walls = find_walls(geometry, faces, lines, c.conformed, of_blocks ? &*of_blocks : nullptr,
                             execution);
        if (c.walls.missing.empty()) return c;
        if (blocks == nullptr)
            faces.polygons.points = points_of_corners(c.plan_vertices, c.conformed, execution);
        c.crossings.insert(c.crossings.end(), c.walls.missing.begin(), c.walls.missing.end());
    }
    const exact::Point& at = geometry.point(c.crossings.back().point);
    throw InternalError("columns that cross in height have a vertex there in the next round",
                        std::array{at.x, at.y, 0.0});
}

/// Names the cells that rounding left without a volume.
Warning left_flat(const std::vector<FlatCell>& flat, const CellComplex& complex) {
    const auto& [cell, at] = flat.front();
    Warning warning{"flat_cells", complex.cell_block[static_cast<std::size_t>(cell)], {}, {}};
    for (const FlatCell& one : flat)
        warning.items.push_back(one.cell);
    warning.text = std::to_string(flat.size()) + (flat.size() == 1 ? " cell is" : " cells are") +
                   " thinner than the spacing of doubles and stayed flat, the first at (" +
                   std::to_string(at[0]) + ", " + std::to_string(at[1]) + ")";
    return warning;
}

}  // namespace

BuiltCells build_cells(exact::PlanArrangement& geometry, Construction& construction,
                       const BlockLinks* blocks, const std::vector<std::int32_t>& surface_of_plane,
                       const std::optional<Window>& window, const Execution& execution) {
    geometry.forget_names();
    Conformed c = conform(geometry, construction, blocks, execution);
    FaceList& faces = construction.faces;
    if (blocks == nullptr) {  // no round will ask for corners again
        faces.polygons.lines = {};
        faces.surface = {};
        c.plan_vertices.of_point = {};
    }
    set_plan_positions(geometry, c.plan_vertices, execution);
    if (construction.may_lack_nodes) {
        for (auto* nodes : {&faces.above, &faces.below})
            std::replace(nodes->begin(), nodes->end(), kLeftOut, kOutsideCell);
    }
    std::optional<TileBorder> border;
    if (window) {
        border =
            find_tile_border(geometry, faces, c.plan_vertices, c.conformed, *window, execution);
    }
    Array<PlanOffset> plan_off = find_plan_offsets(geometry, c.plan_vertices, execution);
    // What comes out takes the memory of what it was made of.
    if (blocks == nullptr) geometry.forget_all();
    begin_step(execution.progress, c.done, 1.0 - c.done, "putting the cells together");
    set_vertex_positions(c.plan_vertices, c.conformed, execution);
    Array<std::int32_t> cell_block;
    std::vector<std::int32_t> cell_of_node;
    if (blocks == nullptr) {
        cell_block = std::move(construction.node_block);
    } else {
        auto& links = construction.links;
        links.insert(links.end(), c.walls.links.begin(), c.walls.links.end());
        cell_of_node =
            cells_of_nodes(construction, blocks->triangles, blocks->wholes, cell_block, execution);
        for (auto* nodes : {&faces.above, &faces.below}) {
            for (std::int32_t& node : *nodes)
                node = node < 0 ? kOutsideCell : cell_of_node[static_cast<std::size_t>(node)];
        }
    }
    const std::vector<FlatCell> flat = make_distinct(geometry, faces, c.plan_vertices, c.conformed,
                                                     border ? &*border : nullptr, execution);
    Array<PlanOffset> vertex_off =
        vertex_offsets(plan_off, c.plan_vertices, c.conformed, execution);
    plan_off = {};
    std::optional<UntouchedTriangles> untouched;
    if (blocks != nullptr) {
        JoinedWalls joined = join_stretches(c.walls.stretches, cell_of_node, faces, c.crossings,
                                            c.plan_vertices, c.conformed, execution);
        c.walls.walls.assign(1, std::move(joined.walls));
        if (border) border->renumber(joined.number);
        renumber(vertex_off, joined.number);
        untouched.emplace(geometry, blocks->wholes, surface_of_plane, faces, c.conformed,
                          execution);
    }
    c.plan_vertices = {};
    if (blocks == nullptr) faces.polygons = {};
    c.conformed.entries = {};
    CellComplex complex = assemble(faces, surface_of_plane, std::move(c.conformed),
                                   std::move(c.walls.walls), std::move(cell_block), execution);
    if (untouched) untouched->add_to(complex, cell_of_node);
    assert(are_closed(complex));
    if (!flat.empty()) complex.warnings.push_back(left_flat(flat, complex));
    BuiltCells built{std::move(complex), {}, std::move(vertex_off)};
    if (border) built.border = std::move(border->vertices);
    return built;
}

}  // namespace realmodel::strata
