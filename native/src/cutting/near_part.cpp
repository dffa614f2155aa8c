// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/near_part.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/ulp.hpp"

namespace realmodel::cutting {

CellBoxes::CellBoxes(const ComplexView& model, const Progress* progress)
    : boxes(model.cell_count()), vertex(model.cell_count(), -1) {
    double largest = 0;
    for (const double x : model.vertices)
        largest = std::max(largest, std::abs(x));
    rounding = 4 * kComputedUlps * ulp(largest);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        spatial::Box box;
        for (const NodeId v : model.face(f))
            box.include(model.vertex(v));
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) < 0) continue;
            boxes[index(model.cell(f, k))].include(box);
            vertex[index(model.cell(f, k))] = model.face(f)[0];
        }
    }
}

std::vector<std::uint8_t> cells_near(const CellBoxes& cells, const NearestSide& surface,
                                     int threads, const Progress* progress) {
    const double margin = 16 * std::max(rounding_of(surface.surface().vertices), cells.rounding);
    std::vector<std::uint8_t> is_near(cells.boxes.size(), 0);
    parallel_ranges(is_near.size(), 1 << 12, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c)
                            is_near[c] = surface.is_near(cells.boxes[c], margin) ? 1 : 0;
                    });
    return is_near;
}

std::vector<std::int8_t> sides_of_far_cells(const ComplexView& model, const CellBoxes& cells,
                                            const NearestSide& surface,
                                            std::span<const std::uint8_t> is_near,
                                            const Progress* progress) {
    DisjointSets joined(model.cell_count());
    const auto is_far = [&](std::int32_t c) { return c >= 0 && is_near[index(c)] == 0; };
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        if (is_far(model.cell(f, 0)) && is_far(model.cell(f, 1)))
            joined.join(model.cell(f, 0), model.cell(f, 1));
    }
    std::vector<std::int8_t> sides(model.cell_count(), kOn), known(model.cell_count(), kOn);
    for (std::int32_t c = 0; index(c) < sides.size(); ++c) {
        if (!is_far(c) || cells.vertex[index(c)] < 0) continue;
        auto& own = known[index(joined.find(c))];
        if (own == kOn) own = surface.side(model.vertex(cells.vertex[index(c)]));
        sides[index(c)] = own;
    }
    return sides;
}

NearPart::NearPart(const ComplexView& model, std::span<const std::uint8_t> is_near)
    : model_(model), number_(model.cell_count(), -1) {
    for (std::int32_t c = 0; index(c) < number_.size(); ++c) {
        if (is_near[index(c)] == 0) continue;
        number_[index(c)] = static_cast<std::int32_t>(cells_.size());
        cells_.push_back(c);
        cell_block_.push_back(model.cell_block[index(c)]);
    }
    std::vector<NodeId> own_vertex(model.vertex_count(), -1);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        std::array<std::int32_t, 2> own{-1, -1};
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) own[k] = number_[index(model.cell(f, k))];
        }
        if (own[0] < 0 && own[1] < 0) continue;
        const auto corners = model.face(f);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const NodeId v = corners[own[0] >= 0 ? i : corners.size() - 1 - i];
            if (own_vertex[index(v)] < 0) {
                own_vertex[index(v)] = static_cast<NodeId>(vertices_.size());
                vertices_.push_back(model.vertex(v));
                vertices_of_.push_back(v);
            }
            face_vertices_.push_back(own_vertex[index(v)]);
        }
        face_offsets_.push_back(static_cast<std::int64_t>(face_vertices_.size()));
        face_cells_.push_back(own[0] >= 0 ? own[0] : own[1]);
        face_cells_.push_back(own[0] >= 0 ? own[1] : -1);
        face_surface_.push_back(model.face_surface[f]);
        faces_.push_back(static_cast<std::int32_t>(f));
        beyond_.push_back(own[0] < 0 ? model.cell(f, 0) : own[1] < 0 ? model.cell(f, 1) : -1);
    }
}

ComplexView NearPart::view() const {
    ComplexView view = model_;
    view.vertices = {reinterpret_cast<const double*>(vertices_.data()), 3 * vertices_.size()};
    view.face_offsets = face_offsets_;
    view.face_vertices = face_vertices_;
    view.face_cells = face_cells_;
    view.face_surface = face_surface_;
    view.cell_block = cell_block_;
    return view;
}

/// Adds a piece in the model's numbers.
void NearPart::add_piece(const Polygons& polygons, std::size_t p, Piece piece,
                         Pieces& pieces) const {
    const auto own = static_cast<NodeId>(vertices_.size());
    const auto all = static_cast<NodeId>(model_.vertex_count());
    for (const NodeId node : polygons[p]) {
        pieces.polygons.nodes.push_back(node < own ? vertices_of_[index(node)] : node - own + all);
    }
    pieces.polygons.close();
    if (piece.face >= 0) piece.face = faces_[index(piece.face)];
    for (std::int32_t& cell : piece.cells) {
        if (cell >= 0) cell = cells_[index(cell)];
    }
    pieces.origins.push_back(piece);
}

bool NearPart::put_back(Pieces& pieces, std::vector<HalfCell>& half_cells,
                        std::span<const std::int8_t> sides) const {
    // the parts of near cells and the other cells, in the model's order
    std::vector<HalfCell> all = std::move(half_cells);
    for (HalfCell& own : all)
        own.cell = cells_[index(own.cell)];
    const std::size_t parts = all.size();
    for (std::int32_t c = 0; index(c) < number_.size(); ++c) {
        if (number_[index(c)] < 0 && sides[index(c)] != kOn) all.push_back({c, sides[index(c)]});
    }
    std::vector<std::int32_t> order(all.size()), number(all.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&all](std::int32_t i) { return all[index(i)].cell; });
    std::vector<std::int32_t> far_part(number_.size(), -1);
    half_cells.clear();
    for (const std::int32_t i : order) {
        number[index(i)] = checked_number(half_cells.size(), "parts of cells");
        if (index(i) >= parts) far_part[index(all[index(i)].cell)] = number[index(i)];
        half_cells.push_back(all[index(i)]);
    }
    // pieces in the order of the model's faces, then caps
    const Pieces near = std::move(pieces);
    std::vector<std::int32_t> of_faces(near.size());
    std::iota(of_faces.begin(), of_faces.end(), 0);
    const auto key = [&](std::int32_t p) {
        const std::int32_t face = near[index(p)].face;
        return face < 0 ? INT32_MAX : face;
    };
    std::ranges::stable_sort(of_faces, {}, key);
    pieces = {};
    auto beside = std::ranges::count_if(
        beyond_, [&](std::int32_t cell) { return cell >= 0 && far_part[index(cell)] >= 0; });
    std::size_t next = 0;
    const auto add_near = [&](std::size_t until) {
        for (; next < of_faces.size(); ++next) {
            const auto p = index(of_faces[next]);
            Piece piece = near[p];
            if (piece.face >= 0 && index(faces_[index(piece.face)]) > until) break;
            if (piece.face < 0 && until < model_.face_count()) break;
            for (std::int32_t& part : piece.parts) {
                if (part >= 0) part = number[index(part)];
            }
            const std::int32_t beyond = piece.face < 0 ? -1 : beyond_[index(piece.face)];
            if (beyond >= 0 && far_part[index(beyond)] >= 0) {
                const auto begin = index(face_offsets_[index(piece.face)]);
                const auto end = index(face_offsets_[index(piece.face) + 1]);
                if (piece.parts[1] >= 0 ||
                    !std::ranges::equal(near.polygons[p],
                                        std::span(face_vertices_).subspan(begin, end - begin)))
                    return;
                piece.parts[1] = far_part[index(beyond)];
                piece.sides[1] = sides[index(beyond)];
                --beside;
            }
            add_piece(near.polygons, p, piece, pieces);
            if (beyond >= 0) pieces.origins.back().cells[1] = beyond;
        }
    };
    for (std::size_t f = 0; f < model_.face_count(); ++f) {
        add_near(f);
        const std::array<std::int32_t, 2> cells{model_.cell(f, 0), model_.cell(f, 1)};
        const auto is_near = [this](std::int32_t c) { return c >= 0 && number_[index(c)] >= 0; };
        if (is_near(cells[0]) || is_near(cells[1])) continue;
        Piece piece{static_cast<std::int32_t>(f), cells, {kOn, kOn}, false};
        for (std::size_t k = 0; k < 2; ++k) {
            if (cells[k] < 0) continue;
            piece.sides[k] = sides[index(cells[k])];
            piece.parts[k] = far_part[index(cells[k])];
        }
        if (piece.parts[0] >= 0 || piece.parts[1] >= 0) pieces.add(model_.face(f), piece);
    }
    add_near(model_.face_count());
    return beside == 0;
}

}  // namespace realmodel::cutting
