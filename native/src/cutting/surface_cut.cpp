// SPDX-License-Identifier: GPL-3.0-or-later
// A model cut by a surface or a block: what meets what, what lies where, the parts of cells,
// halves.
#include <algorithm>
#include <optional>

#include "base/parallel.hpp"
#include "cutting/assembly.hpp"
#include "cutting/cell_parts.hpp"
#include "cutting/near_model.hpp"
#include "cutting/pieces.hpp"
#include "cutting/rounding/part_rounding.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

namespace {

/// The cut where only a part of the model is near; nothing where rounding went beyond it.
std::optional<Cut> cut(const ComplexView& model, const Cutter& cutter, const NearModel& near_model,
                       std::span<const std::int8_t> sides_beside, const Execution& execution) {
    const ComplexView near = near_model.view();
    CutterOverlay overlay(near, cutter, execution, 0, {}, near_model.far());
    if (overlay.reaches_far_faces()) return std::nullopt;
    begin_phase(execution.progress, 0.3, 0.5, "finding what the surface goes through");
    const CutterWinding winding(overlay, execution.progress);
    const CutterSides sides(overlay, winding, execution.progress);
    begin_phase(execution.progress, 0.5, 0.68, "finding the parts of cells");
    CellParts made(overlay, winding, sides, execution.progress);
    begin_phase(execution.progress, 0.85, 0.92, "rounding what was cut");
    round_parts({near, overlay.new_positions(), made.pieces, made.half_cells, false, execution,
                 near_model.far()},
                made.touches);
    const auto pieces = near_model.put_back(std::move(made.pieces), made.half_cells, sides_beside);
    if (!pieces) return std::nullopt;
    begin_phase(execution.progress, 0.95, 1.0, "putting the halves together");
    Cut halves =
        assemble_halves(model, overlay.new_positions(), *pieces, made.half_cells, execution);
    halves.below_touches = made.touches[0];
    halves.above_touches = made.touches[1];
    return halves;
}

Cut cut(const ComplexView& model, const Cutter& cutter, const Execution& execution) {
    std::vector<std::uint8_t> is_near;
    std::vector<std::int8_t> sides;
    std::optional<NearModel> near_model;
    {
        const NearestSide nearest(cutter, execution);
        const CellBoxes cells(model, {&nearest, 1}, execution);
        is_near = cells_near(cells, nearest, execution);
        sides = sides_of_far_cells(model, nearest, is_near, execution);
        near_model.emplace(model, is_near, execution, &nearest, margin_of(cells, nearest));
    }
    if (auto halves = cut(model, cutter, *near_model, sides, execution)) return *std::move(halves);
    is_near.assign(is_near.size(), 1);
    sides.assign(sides.size(), kOn);
    return *cut(model, cutter, NearModel(model, is_near, execution), sides, execution);
}

bool is_same(const ComplexView& one, const ComplexView& other) {
    const auto equal = [](const auto& a, const auto& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    };
    return equal(one.vertices, other.vertices) && equal(one.face_vertices, other.face_vertices) &&
           equal(one.face_offsets, other.face_offsets) && equal(one.face_cells, other.face_cells) &&
           equal(one.cell_block, other.cell_block);
}

/// A model's own block taken out of it: no cell is cut.
Cut separate_block(const ComplexView& model, std::int32_t block, const Execution& execution) {
    if (std::find(model.cell_block.begin(), model.cell_block.end(), block) ==
        model.cell_block.end())
        throw InputError("no_block", "the block that is to cut has no cells", -1, {block});
    CutPieces pieces;
    Polygons polygons;
    std::vector<HalfCell> cells;
    const auto side = [&](std::int32_t cell) {
        return cell < 0 ? kOn : model.block(cell) == block ? kBelow : kAbove;
    };
    for (std::size_t c = 0; c < model.cell_block.size(); ++c) {
        const auto cell = static_cast<std::int32_t>(c);
        cells.push_back({cell, side(cell)});
    }
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(execution.progress, f);
        const std::array<std::int32_t, 2> face_cells{model.cell(f, 0), model.cell(f, 1)};
        const std::array<std::int8_t, 2> sides{side(face_cells[0]), side(face_cells[1])};
        const bool bounds = (sides[0] == kBelow) != (sides[1] == kBelow);
        const CutPiece origin{static_cast<std::int32_t>(f), face_cells, sides, bounds, face_cells};
        polygons.clear();
        if (bounds && face_cells[1] >= 0) {
            divide_face(model, f, polygons);
        } else {
            polygons.add(model.face(f));
        }
        for (std::size_t p = 0; p < polygons.size(); ++p)
            pieces.add(polygons[p], origin);
    }
    return assemble_halves(model, {}, WholePieces(std::move(pieces)), cells, execution);
}

}  // namespace

Cut cut_by_surface(const ComplexView& model, const TriangleView& surface,
                   const Execution& execution) {
    check_model(model);
    return cut(model, oriented_cutter(surface), execution);
}

Cut cut_by_block(const ComplexView& model, const ComplexView& other, std::int32_t block,
                 const Execution& execution) {
    check_model(model);
    check_model(other);
    if (is_same(model, other)) return separate_block(model, block, execution);
    return cut(model, block_boundary(other, block), execution);
}

}  // namespace realmodel::cutting
