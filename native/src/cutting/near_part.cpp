// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/near_part.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/ulp.hpp"
#include "cutting/nearest_side.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

using spatial::Box;
using spatial::BoxTree;

namespace {

Position corner(const CutterSurface& surface, std::int32_t triangle, std::size_t i) {
    return surface.vertices[index(surface.triangles[index(triangle)][i])];
}

/// Whether the plane of a triangle may pass through a box.
bool plane_meets(const CutterSurface& surface, std::int32_t triangle, const Box& box) {
    constexpr double kRounding = 0x1p-40;
    const Position a = corner(surface, triangle, 0);
    const Position normal =
        polygon_normal(std::array{a, corner(surface, triangle, 1), corner(surface, triangle, 2)});
    double distance = 0, reach = 0, size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double off = (box.low[k] + box.high[k]) / 2 - a[k];
        distance += normal[k] * off;
        reach += std::abs(normal[k]) * (box.high[k] - box.low[k]) / 2;
        size += std::abs(normal[k] * off);
    }
    return std::abs(distance) <= reach + kRounding * size;
}

}  // namespace

std::vector<std::uint8_t> cells_near(const ComplexView& model, const CutterSurface& surface,
                                     int threads, const Progress* progress) {
    double margin = rounding_of(surface.vertices);
    for (const double x : model.vertices)
        margin = std::max(margin, 4 * kComputedUlps * ulp(x));
    margin *= 16;
    std::vector<Box> cells(model.cell_count());
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        Box box;
        for (const NodeId v : model.face(f))
            box.include(model.vertex(v));
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) cells[index(model.cell(f, k))].include(box);
        }
    }
    std::vector<Box> boxes;
    for (std::int32_t t = 0; index(t) < surface.triangles.size(); ++t) {
        Box& box = boxes.emplace_back();
        for (std::size_t i = 0; i < 3; ++i)
            box.include(corner(surface, t, i));
        box.widen(margin);
    }
    const BoxTree tree(std::move(boxes));
    std::vector<std::uint8_t> is_near(cells.size(), 0);
    parallel_ranges(cells.size(), 1 << 12, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c) {
                            Box box = cells[c];
                            box.widen(margin);
                            tree.find(box, [&](std::int32_t t) {
                                if (is_near[c] == 0 && plane_meets(surface, t, box)) is_near[c] = 1;
                            });
                        }
                    });
    return is_near;
}

std::vector<std::int8_t> sides_of_far_cells(const ComplexView& model, const CutterSurface& surface,
                                            std::span<const std::uint8_t> is_near,
                                            const Progress* progress) {
    const NearestSide side(surface);
    DisjointSets joined(model.cell_count());
    std::vector<NodeId> vertex(model.cell_count(), -1);  // one of each cell
    const auto is_far = [&](std::int32_t c) { return c >= 0 && is_near[index(c)] == 0; };
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) vertex[index(model.cell(f, k))] = model.face(f)[0];
        }
        if (is_far(model.cell(f, 0)) && is_far(model.cell(f, 1)))
            joined.join(model.cell(f, 0), model.cell(f, 1));
    }
    std::vector<std::int8_t> sides(model.cell_count(), kOn), known(model.cell_count(), kOn);
    for (std::int32_t c = 0; index(c) < sides.size(); ++c) {
        if (!is_far(c) || vertex[index(c)] < 0) continue;
        auto& own = known[index(joined.find(c))];
        if (own == kOn) {
            const Position p = model.vertex(vertex[index(c)]);
            own = surface.is_closed ? side.within(p) : side(p);
        }
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
