// SPDX-License-Identifier: GPL-3.0-or-later
// Models of the parts that structures leave, cut and joined.
#include <algorithm>
#include <map>
#include <optional>

#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "cutting/model_check.hpp"
#include "cutting/near_part.hpp"
#include "cutting/nearest_side.hpp"
#include "cutting/part_rounding.hpp"
#include "cutting/surface_parts.hpp"
#include "exact/space_predicates.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/cells/volumes.hpp"
#include "structures/near_cells.hpp"
#include "structures/wanted_parts.hpp"

namespace realmodel::structures {

using cutting::kAbove;
using cutting::kBelow;
using spatial::Box;

namespace {

Box box_of(const ComplexView& model) {
    Box box;
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        box.include(model.vertex(static_cast<std::int32_t>(v)));
    return box;
}

/// Cells of several models with the vertices that they share once.
struct Together {
    std::vector<Position> vertices;
    std::vector<std::int64_t> face_offsets{0};
    std::vector<std::int32_t> face_vertices, face_cells, face_surface, cell_block;
    std::vector<std::int32_t> model_of_cell;
    std::vector<std::uint8_t> is_near;  ///< of cells
    std::size_t blocks = 0;
    std::int32_t surfaces = 0;
    CellKind cell_kind = CellKind::kColumns;

    void reserve(std::span<const PartModel> models);
    void add(const ComplexView& model, std::int32_t number, std::span<const Place> places);
    void share_vertices(int threads, const Progress* progress);
    ComplexView view() const {
        return {.vertices = {reinterpret_cast<const double*>(vertices.data()), 3 * vertices.size()},
                .face_offsets = face_offsets,
                .face_vertices = face_vertices,
                .face_cells = face_cells,
                .face_surface = face_surface,
                .cell_block = cell_block,
                .blocks = blocks,
                .surfaces = surfaces,
                .cell_kind = cell_kind};
    }
};

void Together::reserve(std::span<const PartModel> models) {
    std::size_t positions = 0, faces = 0, corners = 0, cells = 0;
    for (const PartModel& own : models) {
        positions += own.model.vertex_count();
        faces += own.model.face_count();
        corners += own.model.face_vertices.size();
        cells += own.model.cell_count();
    }
    vertices.reserve(positions);
    face_offsets.reserve(faces + 1);
    face_vertices.reserve(corners);
    face_cells.reserve(2 * faces);
    face_surface.reserve(faces);
    for (auto* of_cells : {&cell_block, &model_of_cell})
        of_cells->reserve(cells);
    is_near.reserve(cells);
}

void Together::add(const ComplexView& model, std::int32_t number, std::span<const Place> places) {
    const auto first_vertex = checked_number(vertices.size() + model.vertex_count(), "vertices") -
                              static_cast<std::int32_t>(model.vertex_count());
    std::vector<std::int32_t> cell(model.cell_count(), -1);
    for (std::size_t c = 0; c < cell.size(); ++c) {
        if (places[c] == Place::kElsewhere) continue;
        cell[c] = checked_number(cell_block.size(), "cells");
        cell_block.push_back(model.cell_block[c]);
        model_of_cell.push_back(number);
        is_near.push_back(places[c] == Place::kNear ? 1 : 0);
    }
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        vertices.push_back(model.vertex(static_cast<std::int32_t>(v)));
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        std::array<std::int32_t, 2> own{-1, -1};
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) own[k] = cell[index(model.cell(f, k))];
        }
        if (own[0] < 0 && own[1] < 0) continue;
        const auto corners = model.face(f);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            face_vertices.push_back(first_vertex +
                                    corners[own[0] >= 0 ? i : corners.size() - 1 - i]);
        }
        face_offsets.push_back(static_cast<std::int64_t>(face_vertices.size()));
        face_cells.push_back(own[0] >= 0 ? own[0] : own[1]);
        face_cells.push_back(own[0] >= 0 ? own[1] : -1);
        face_surface.push_back(model.face_surface[f]);
    }
    blocks = std::max(blocks, model.blocks);
    surfaces = std::max(surfaces, model.surfaces);
    if (model.cell_kind == CellKind::kBlocks) cell_kind = CellKind::kBlocks;
}

/// Equal positions get one vertex, those that no face has none.
void Together::share_vertices(int threads, const Progress* progress) {
    std::vector<std::uint8_t> is_used(vertices.size(), 0);
    for (const std::int32_t v : face_vertices)
        is_used[index(v)] = 1;
    std::vector<std::pair<Position, std::int32_t>> order;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        Position p = vertices[v];
        for (double& x : p)
            x += 0.0;  // both zeros alike
        if (is_used[v] != 0) order.push_back({p, static_cast<std::int32_t>(v)});
    }
    parallel_sort(order, std::less<>(), threads, progress);
    std::vector<std::int32_t> number(vertices.size(), -1);
    std::vector<Position> distinct;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || order[i].first != order[i - 1].first) distinct.push_back(order[i].first);
        number[index(order[i].second)] = static_cast<std::int32_t>(distinct.size() - 1);
    }
    for (std::int32_t& v : face_vertices)
        v = number[index(v)];
    vertices = std::move(distinct);
}

void begin(Progress* progress, double from, double to, const char* what) {
    if (progress != nullptr) progress->begin(from, to, what);
}

/// The faces of what is left of the cells.
CellComplex assemble(const Together& together, const std::vector<Position>& new_positions,
                     const cutting::WholePieces& pieces, std::span<const cutting::HalfCell> cells,
                     const Progress* progress) {
    CellComplex complex;
    complex.cell_kind = together.cell_kind;
    for (const cutting::HalfCell& cell : cells)
        complex.cell_block.push_back(together.cell_block[index(cell.cell)]);
    const std::size_t own = together.vertices.size();
    std::vector<std::int32_t> number(own + new_positions.size(), -1);
    const cutting::Pieces& near = pieces.near();
    complex.face_offsets.reserve(together.face_surface.size() + near.size() + 1);
    complex.face_vertices.reserve(together.face_vertices.size() + near.polygons.nodes.size());
    complex.face_cells.reserve(together.face_surface.size() + near.size());
    complex.face_surface.reserve(together.face_surface.size() + near.size());
    complex.face_offsets.push_back(0);
    std::size_t visited = 0;
    pieces.each([&](std::span<const cutting::NodeId> nodes, const cutting::Piece& piece) {
        poll(progress, visited++);
        if (piece.parts[0] < 0 && piece.parts[1] < 0) return;
        const bool reversed = piece.parts[0] < 0;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const auto node = index(nodes[reversed ? nodes.size() - 1 - i : i]);
            if (number[node] < 0) {
                number[node] = static_cast<std::int32_t>(complex.vertices.size());
                complex.vertices.push_back(node < own ? together.vertices[node]
                                                      : new_positions[node - own]);
            }
            complex.face_vertices.push_back(number[node]);
        }
        complex.face_offsets.push_back(static_cast<std::int64_t>(complex.face_vertices.size()));
        complex.face_cells.push_back(reversed ? std::array{piece.parts[1], -1} : piece.parts);
        complex.face_surface.push_back(piece.face < 0 ? WantedParts::surface_of_cap(piece.face)
                                                      : together.face_surface[index(piece.face)]);
    });
    return complex;
}

/// Joins the models where only the cells that are near structures take part in cutting; nothing
/// where rounding went beyond them.
std::optional<Joined> join(const Together& together, const StructureSurface& surface,
                           std::span<const PartModel> models, std::span<const Structure> structures,
                           std::span<const std::uint8_t> acts, int threads, Progress* progress) {
    const ComplexView all = together.view();
    const cutting::NearPart part(all, together.is_near, threads, progress);
    const ComplexView near = part.view();
    std::vector<std::int32_t> model_of_cell;
    for (std::int32_t c = 0; index(c) < near.cell_count(); ++c)
        model_of_cell.push_back(together.model_of_cell[index(part.cell(c))]);
    begin(progress, 0.1, 0.15, "finding faces near structures");
    SurfaceOverlay overlay(near, surface.surface, threads, progress);
    begin(progress, 0.3, 0.5, "finding what structures go through");
    const CutterWinding winding(overlay, progress);
    const StructureSides sides(overlay, winding, surface, structures, progress);
    std::vector<Sides> model_sides;
    for (const PartModel& own : models)
        model_sides.push_back(own.sides);
    const WantedParts wanted(overlay, winding, sides, model_of_cell, model_sides, acts);
    begin(progress, 0.5, 0.68, "finding the parts of cells");
    cutting::SurfaceParts made(overlay, winding, wanted, progress);
    begin(progress, 0.85, 0.92, "rounding what was cut");
    cutting::PartRounding(near, overlay.new_positions(), made.pieces, made.half_cells, made.touches,
                          threads, progress, true)
        .run();
    const std::vector<std::int8_t> sides_beside(all.cell_count(), kAbove);
    const auto pieces = part.put_back(std::move(made.pieces), made.half_cells, sides_beside);
    if (!pieces) return std::nullopt;
    begin(progress, 0.95, 1.0, "putting the parts together");
    Joined joined;
    joined.complex =
        assemble(together, overlay.new_positions(), *pieces, made.half_cells, progress);
    for (const cutting::HalfCell& cell : made.half_cells)
        joined.cell_part.push_back(together.model_of_cell[index(cell.cell)]);
    joined.complex.volumes =
        strata::block_volumes(joined.complex, together.blocks, threads, progress);
    return joined;
}

}  // namespace

std::vector<Part> parts_of(const ComplexView& rock, std::span<const Structure> structures,
                           int threads, Progress* progress) {
    cutting::check_model(rock);
    const StructureSurface surface = structure_surface(structures, box_of(rock));
    SurfaceOverlay overlay(rock, surface.surface, threads, progress);
    const CutterWinding winding(overlay, progress);
    const StructureSides sides(overlay, winding, surface, structures, progress);
    std::map<Sides, Box> boxes;
    const auto include = [&](std::size_t part, const auto& loops) {
        Box& box = boxes[sides.sides(part)];
        for (const auto& loop : loops) {
            for (const NodeId node : loop)
                box.include(overlay.position(node));
        }
    };
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (!overlay.of_cutter(r)) {
            if (winding.level(r) < 0) include(sides.part_of(r), overlay.loops(r));
        } else if (winding.counts(r) && winding.touches_model(r)) {
            for (std::size_t k = 0; k < 2; ++k) {
                if (!winding.around(r, k).empty()) include(sides.part_at(r, k), overlay.loops(r));
            }
        }
    }
    for (std::size_t f = 0; f < rock.face_count(); ++f) {
        if (!overlay.is_active(f))
            include(sides.part_of(overlay.size() + f), std::array{rock.face(f)});
    }
    std::vector<Part> parts;
    for (const auto& [own, box] : boxes)
        parts.push_back({own, box.low, box.high});
    return parts;
}

Joined join_models(std::span<const PartModel> models, std::span<const Structure> structures,
                   std::span<const std::uint8_t> acts, int threads, Progress* progress) {
    Together together;
    Box rock;
    for (const PartModel& own : models) {
        cutting::check_model(own.model);
        rock.include(box_of(own.model));
    }
    const StructureSurface surface = structure_surface(structures, rock);
    const std::vector<cutting::NearestSide> nearest(surface.single.begin(), surface.single.end());
    begin(progress, 0, 0.1, "leaving out what is in other parts");
    together.reserve(models);
    for (std::size_t m = 0; m < models.size(); ++m) {
        together.add(models[m].model, static_cast<std::int32_t>(m),
                     places_of_cells(models[m].model, models[m].sides, nearest, structures, threads,
                                     progress));
    }
    together.share_vertices(threads, progress);
    if (auto joined = join(together, surface, models, structures, acts, threads, progress))
        return *std::move(joined);
    together.is_near.assign(together.is_near.size(), 1);
    return *join(together, surface, models, structures, acts, threads, progress);
}

std::vector<std::int8_t> sides_of_points(std::span<const Structure> structures,
                                         std::span<const double> points, int threads,
                                         const Progress* progress) {
    Box box;
    for (std::size_t i = 0; i + 2 < points.size(); i += 3)
        box.include(Position{points[i], points[i + 1], points[i + 2]});
    const StructureSurface surface = first_surface(structures, box);
    const cutting::NearestSide nearest(surface.single[0]);
    // what is beside the fault itself is on its side, wherever its continuation goes
    const cutting::CutterSurface own = checked_surface(structures[0], 0);
    const cutting::NearestSide beside(own);
    std::vector<std::int8_t> sides(points.size() / 3);
    parallel_ranges(sides.size(), 1 << 8, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            const Position p{points[3 * i], points[3 * i + 1], points[3 * i + 2]};
                            bool at_border = false;
                            const std::int8_t side =
                                structures[0].is_body ? nearest.within(p) : beside(p, &at_border);
                            sides[i] = at_border ? nearest(p) : side;
                        }
                    });
    return sides;
}

}  // namespace realmodel::structures
