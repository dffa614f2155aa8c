// SPDX-License-Identifier: GPL-3.0-or-later
// Models of the compartments that structures leave, cut and joined.
#include <algorithm>
#include <cassert>
#include <map>
#include <optional>

#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "cutting/assembly.hpp"
#include "cutting/cell_parts.hpp"
#include "cutting/near_model.hpp"
#include "cutting/nearest_side.hpp"
#include "cutting/pieces.hpp"
#include "exact/space_points.hpp"
#include "strata/cells/volumes.hpp"
#include "structures/joined_rounding.hpp"
#include "structures/merge_vertices.hpp"
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

/// Of a cell of a model: that it comes near a structure and is not on the wrong side of another,
/// that it comes near none and is on the sides that are asked for, or that it is elsewhere.
enum class CellLocation : std::uint8_t { kElsewhere, kInside, kNear };

/// @param nearest  of each structure where its sides are
std::vector<CellLocation> locations_of_cells(const ComplexView& model, const Sides& sides,
                                             std::span<const cutting::NearestSide> nearest,
                                             std::span<const Structure> structures,
                                             const Execution& execution) {
    assert(sides.size() == nearest.size() && sides.size() == structures.size());
    const cutting::CellBoxes cells(model, nearest, execution);
    std::vector<CellLocation> locations(model.cell_count(), CellLocation::kInside);
    for (std::size_t s = 0; s < sides.size(); ++s) {
        auto is_near = cutting::cells_near(cells, nearest[s], execution);
        for (std::size_t c = 0; c < locations.size(); ++c) {
            if (locations[c] == CellLocation::kElsewhere) {
                is_near[c] = 1;  // not asked for
            } else if (is_near[c] != 0) {
                locations[c] = CellLocation::kNear;
            }
        }
        if (sides[s] == 0) continue;  // either side will do
        // some corners of these may lie where the branch is not, and nearest to its other side
        for (const std::int32_t other : structures[s].ends_at) {
            const auto beside = cutting::cells_near(cells, nearest[index(other)], execution);
            for (std::size_t c = 0; c < locations.size(); ++c) {
                if (beside[c] != 0) is_near[c] = 1;
            }
        }
        const auto sides_of_cells =
            cutting::sides_of_far_cells(model, nearest[s], is_near, execution);
        for (std::size_t c = 0; c < locations.size(); ++c) {
            if (sides_of_cells[c] != cutting::kOn && sides_of_cells[c] != sides[s])
                locations[c] = CellLocation::kElsewhere;
        }
    }
    return locations;
}

/// Cells of several models, with the vertices that they share once.
struct MergedModels : CellComplex {
    std::vector<std::int32_t> model_of_cell;
    std::vector<std::uint8_t> is_near;  ///< of cells
    std::vector<Sides> model_sides;
    std::size_t blocks = 0;
    std::int32_t surfaces = 0;

    MergedModels(std::span<const CompartmentModel> models,
                 const std::vector<std::vector<CellLocation>>& locations,
                 const Execution& execution);
    void share_vertices(const Execution& execution);
    ComplexView view() const {
        ComplexView view = *this;
        view.blocks = blocks;
        view.surfaces = surfaces;
        return view;
    }
};

/// @param locations  of the cells of each model
MergedModels::MergedModels(std::span<const CompartmentModel> models,
                           const std::vector<std::vector<CellLocation>>& locations,
                           const Execution& execution) {
    // the cells and faces of each model that are wanted: how many, then how many before
    std::vector<std::size_t> positions, cells(models.size()), faces(models.size()),
        corners(models.size());
    const auto is_wanted = [&](std::size_t m, std::int32_t cell) {
        return cell >= 0 && locations[m][index(cell)] != CellLocation::kElsewhere;
    };
    const auto for_each_face = [&](std::size_t m, const auto& visit) {
        const ComplexView& model = models[m].model;
        for (std::size_t f = 0; f < model.face_count(); ++f) {
            const std::array wanted{is_wanted(m, model.cell(f, 0)), is_wanted(m, model.cell(f, 1))};
            if (wanted[0] || wanted[1]) visit(f, wanted);
        }
    };
    for (const CompartmentModel& compartment : models) {
        positions.push_back(compartment.model.vertex_count());
        model_sides.push_back(compartment.sides);
        blocks = std::max(blocks, compartment.model.blocks);
        surfaces = std::max(surfaces, compartment.model.surfaces);
        if (compartment.model.cell_kind == CellKind::kBlocks) cell_kind = CellKind::kBlocks;
    }
    parallel_chunks(models.size(), execution, [&](std::size_t m) {
        cells[m] = locations[m].size() - static_cast<std::size_t>(std::ranges::count(
                                             locations[m], CellLocation::kElsewhere));
        std::size_t face_count = 0, corner_count = 0;
        for_each_face(m, [&](std::size_t f, const auto&) {
            ++face_count;
            corner_count += models[m].model.face(f).size();
        });
        faces[m] = face_count;
        corners[m] = corner_count;
    });
    vertices.resize(exclusive_scan(positions));
    cell_block.resize(exclusive_scan(cells));
    checked_number(vertices.size(), "vertices");
    checked_number(cell_block.size(), "cells");
    model_of_cell.resize(cell_block.size());
    is_near.resize(cell_block.size());
    face_surface.resize(exclusive_scan(faces));
    face_cells.resize(face_surface.size());
    face_vertices.resize(exclusive_scan(corners));
    face_offsets.resize(face_surface.size() + 1);
    face_offsets.back() = static_cast<std::int64_t>(face_vertices.size());
    parallel_chunks(models.size(), execution, [&](std::size_t m) {
        const ComplexView& model = models[m].model;
        std::vector<std::int32_t> number(model.cell_count(), -1);
        std::size_t cell = cells[m], face = faces[m], corner = corners[m];
        for (std::size_t c = 0; c < number.size(); ++c) {
            if (locations[m][c] == CellLocation::kElsewhere) continue;
            number[c] = static_cast<std::int32_t>(cell);
            cell_block[cell] = model.cell_block[c];
            model_of_cell[cell] = static_cast<std::int32_t>(m);
            is_near[cell++] = locations[m][c] == CellLocation::kNear ? 1 : 0;
        }
        for (std::size_t v = 0; v < model.vertex_count(); ++v)
            vertices[positions[m] + v] =  // both zeros alike
                plus(model.vertex(static_cast<std::int32_t>(v)), Position{});
        for_each_face(m, [&](std::size_t f, const std::array<bool, 2>& wanted) {
            const auto loop = model.face(f);
            face_offsets[face] = static_cast<std::int64_t>(corner);
            for (std::size_t i = 0; i < loop.size(); ++i) {
                face_vertices[corner++] = static_cast<std::int32_t>(positions[m]) +
                                          loop[wanted[0] ? i : loop.size() - 1 - i];
            }
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t which = wanted[0] ? k : 1 - k;
                face_cells[face][k] = wanted[which] ? number[index(model.cell(f, which))] : -1;
            }
            face_surface[face++] = model.face_surface[f];
        });
        assert(face == (m + 1 < faces.size() ? faces[m + 1] : face_surface.size()));
        assert(cell == (m + 1 < cells.size() ? cells[m + 1] : cell_block.size()));
    });
}

/// Equal positions of near cells get one vertex, and are numbered in their order. Vertices of other
/// cells alone are of one model each, for between two compartments there is a structure.
void MergedModels::share_vertices(const Execution& execution) {
    std::vector<std::uint8_t> is_shared(vertices.size(), 0);
    for (std::size_t f = 0; f < face_surface.size(); ++f) {
        if (std::ranges::none_of(face_cells[f], [&](std::int32_t cell) {
                return cell >= 0 && is_near[index(cell)] != 0;
            }))
            continue;
        for (auto i = index(face_offsets[f]); i < index(face_offsets[f + 1]); ++i)
            is_shared[index(face_vertices[i])] = 1;
    }
    if (vertices.empty()) return;
    merge_vertices({vertices[0].data(), vertices.size(), is_shared.data(), face_vertices.data(),
                    face_vertices.size()},
                   execution);
}

/// The faces of what is left of the cells.
CellComplex assemble(const MergedModels& merged, const std::vector<Position>& new_positions,
                     const cutting::WholePieces& pieces, std::span<const cutting::HalfCell> cells,
                     const Execution& execution) {
    CellComplex complex;
    complex.cell_kind = merged.cell_kind;
    for (const cutting::HalfCell& cell : cells)
        complex.cell_block.push_back(merged.cell_block[index(cell.cell)]);
    const std::size_t merged_vertices = merged.vertices.size();
    cutting::ChunkedComplex chunked(complex, pieces.chunks());
    const auto is_left = [](const cutting::CutPiece& piece) {
        return piece.parts[0] >= 0 || piece.parts[1] >= 0;
    };
    parallel_chunks(pieces.chunks(), execution, [&](std::size_t chunk) {
        pieces.for_each_of(
            chunk, [&](std::span<const cutting::NodeId> nodes, const cutting::CutPiece& piece) {
                if (is_left(piece)) chunked.count(chunk, nodes.size());
            });
    });
    chunked.make_room();
    parallel_chunks(pieces.chunks(), execution, [&](std::size_t chunk) {
        cutting::ChunkedComplex::Writer writer(chunked, chunk);
        pieces.for_each_of(
            chunk, [&](std::span<const cutting::NodeId> nodes, const cutting::CutPiece& piece) {
                if (!is_left(piece)) return;
                writer.write(nodes, piece.parts,
                             piece.face < 0 ? WantedParts::surface_of_cut_face(piece.face)
                                            : merged.face_surface[index(piece.face)]);
            });
    });
    cutting::number_nodes(
        complex.face_vertices, merged_vertices + new_positions.size(),
        [&](cutting::NodeId node) {
            return index(node) < merged_vertices ? merged.vertices[index(node)]
                                                 : new_positions[index(node) - merged_vertices];
        },
        complex.vertices);
    return complex;
}

/// On which side of each structure something is.
std::vector<cutting::NearestSide> nearest_sides(const StructureCutter& cutter,
                                                const Execution& execution) {
    return transformed(cutter.single, [&](const cutting::Cutter& single) {
        return cutting::NearestSide(single, execution);
    });
}

/// The structures that models are joined at.
struct StructuresHere {
    const StructureCutter& cutter;
    std::span<const Structure> structures;
    std::span<const cutting::NearestSide> nearest;  ///< of single ones
};

/// Joins the models where only the cells that are near structures take part in cutting; nothing
/// where rounding went beyond them.
std::optional<Joined> join(const MergedModels& merged, const StructuresHere& here,
                           std::span<const std::uint8_t> acts, double least_rounding,
                           const Execution& execution) {
    const ComplexView all = merged.view();
    const cutting::NearModel near_model(all, merged.is_near, execution);
    const ComplexView near = near_model.view();
    const auto model_of_cell = transformed(
        near_model.cells(), [&](std::int32_t c) { return merged.model_of_cell[index(c)]; });
    begin_phase(execution.progress, 0.1, 0.15, "finding faces near structures");
    // with what continues a structure nothing else is left undivided
    std::vector<std::int32_t> groups;
    for (std::size_t t = 0; t < here.cutter.structure.size(); ++t)
        groups.push_back(2 * here.cutter.structure[t] + here.cutter.is_continuation[t]);
    CutterOverlay overlay(near, here.cutter.combined, execution, least_rounding, groups);
    begin_phase(execution.progress, 0.3, 0.5, "finding what structures go through");
    const CutterWinding winding(overlay, execution.progress);
    const StructureSides sides(overlay, winding, here.cutter, here.structures, here.nearest,
                               execution.progress);
    assert(model_of_cell.size() == near.cell_count());
    const WantedParts wanted(overlay, winding, sides, model_of_cell, merged.model_sides, acts);
    begin_phase(execution.progress, 0.5, 0.68, "finding the parts of cells");
    cutting::CellParts made(overlay, winding, wanted, execution.progress);
    begin_phase(execution.progress, 0.85, 0.92, "rounding what was cut");
    round_joined_parts(
        {near, overlay.new_positions(), made.pieces, made.half_cells, true, execution},
        made.touches, least_rounding);
    const std::vector<std::int8_t> sides_beside(all.cell_count(), kAbove);
    const auto pieces = near_model.put_back(std::move(made.pieces), made.half_cells, sides_beside);
    if (!pieces) return std::nullopt;
    begin_phase(execution.progress, 0.95, 1.0, "putting the parts together");
    Joined joined;
    joined.complex = assemble(merged, overlay.new_positions(), *pieces, made.half_cells, execution);
    joined.cell_compartment = transformed(made.half_cells, [&](const cutting::HalfCell& cell) {
        return merged.model_of_cell[index(cell.cell)];
    });
    joined.complex.volumes = strata::block_volumes(joined.complex, merged.blocks, execution);
    return joined;
}

/// One cell that fills a box.
CellComplex box_cell(const std::array<Position, 2>& corners) {
    CellComplex cell;
    for (std::size_t v = 0; v < 8; ++v)
        cell.vertices.push_back({corners[v & 1][0], corners[v >> 1 & 1][1], corners[v >> 2][2]});
    cell.face_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    for (std::int64_t begin = 0; begin <= 24; begin += 4)
        cell.face_offsets.push_back(begin);
    cell.face_cells.assign(6, {0, -1});
    cell.face_surface.assign(6, kWall);
    cell.cell_block.push_back(0);
    cell.cell_kind = CellKind::kBlocks;
    return cell;
}

}  // namespace

std::vector<Compartment> compartments_of(const std::array<std::array<double, 3>, 2>& corners,
                                         std::span<const Structure> structures,
                                         const Execution& execution) {
    const CellComplex cell = box_cell(corners);
    ComplexView rock = cell;
    rock.blocks = 1;
    cutting::check_model(rock);
    const StructureCutter cutter = structure_cutter(structures, box_of(rock));
    CutterOverlay overlay(rock, cutter.combined, execution);
    const CutterWinding winding(overlay, execution.progress);
    const auto nearest = nearest_sides(cutter, execution);
    const StructureSides sides(overlay, winding, cutter, structures, nearest, execution.progress);
    std::map<Sides, Box> boxes;
    const auto include = [&](std::size_t compartment, const auto& loops) {
        Box& box = boxes[sides.sides(compartment)];
        for (const auto& loop : loops) {
            for (const NodeId node : loop)
                box.include(overlay.position(node));
        }
    };
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (!overlay.of_cutter(r)) {
            if (winding.coincident(r) < 0) include(sides.compartment_of(r), overlay.loops(r));
        } else if (winding.counts(r) && winding.touches_model(r)) {
            for (std::size_t k = 0; k < 2; ++k) {
                if (!winding.around(r, k).empty())
                    include(sides.compartment_at(r, k), overlay.loops(r));
            }
        }
    }
    for (std::size_t f = 0; f < rock.face_count(); ++f) {
        if (!overlay.is_active(f))
            include(sides.compartment_of(overlay.size() + f), std::array{rock.face(f)});
    }
    return transformed(boxes, [](const auto& box) {
        return Compartment{box.first, box.second.low, box.second.high};
    });
}

Joined join_models(std::span<const CompartmentModel> models, std::span<const Structure> structures,
                   std::span<const std::uint8_t> acts, const Execution& execution,
                   std::span<const ContinuedStructure> continued, double largest) {
    Box rock;
    for (const CompartmentModel& compartment : models) {
        cutting::check_model(compartment.model);
        rock.include(box_of(compartment.model));
    }
    const StructureCutter cutter = continued.empty() ? structure_cutter(structures, rock)
                                                     : structure_cutter(structures, continued);
    const auto nearest = nearest_sides(cutter, execution);
    begin_phase(execution.progress, 0, 0.1, "leaving out what is in other parts");
    const auto locations = transformed(models, [&](const CompartmentModel& compartment) {
        return locations_of_cells(compartment.model, compartment.sides, nearest, structures,
                                  execution);
    });
    MergedModels merged(models, locations, execution);
    merged.share_vertices(execution);
    const double least = largest > 0 ? kComputedUlps * ulp(largest) : 0;
    const StructuresHere here{cutter, structures, nearest};
    if (auto joined = join(merged, here, acts, least, execution)) return *std::move(joined);
    merged.is_near.assign(merged.is_near.size(), 1);
    merged.share_vertices(execution);
    return *join(merged, here, acts, least, execution);
}

}  // namespace realmodel::structures
