// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/near_cells.hpp"

#include <cmath>

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"

namespace realmodel::structures {

using cutting::Position;
using spatial::Box;

namespace {

std::array<Position, 3> corners_of(const cutting::CutterSurface& surface, std::size_t triangle) {
    const auto& t = surface.triangles[triangle];
    return {surface.vertices[index(t[0])], surface.vertices[index(t[1])],
            surface.vertices[index(t[2])]};
}

std::vector<Position> positions_of(const ComplexView& model) {
    std::vector<Position> positions;
    for (std::size_t v = 0; v < model.vertex_count(); ++v)
        positions.push_back(model.vertex(static_cast<std::int32_t>(v)));
    return positions;
}

std::vector<Box> boxes_of(const cutting::CutterSurface& surface) {
    const double margin = cutting::rounding_of(surface.vertices);
    std::vector<Box> boxes;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        Box& box = boxes.emplace_back();
        for (const Position& p : corners_of(surface, t))
            box.include(p);
        box.widen(margin);
    }
    return boxes;
}

/// Whether a plane may pass through a box, which is widened by a share of its distance.
bool plane_meets(const std::array<Position, 3>& triangle, const Box& box) {
    constexpr double kRounding = 0x1p-40;
    const Position normal = cutting::polygon_normal(triangle);
    double distance = 0, reach = 0, size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double off = (box.low[k] + box.high[k]) / 2 - triangle[0][k];
        distance += normal[k] * off;
        reach += std::abs(normal[k]) * (box.high[k] - box.low[k]) / 2;
        size += std::abs(normal[k]) * (std::abs(off) + std::abs(triangle[0][k]));
    }
    return std::abs(distance) <= reach + kRounding * size;
}

}  // namespace

NearCells::NearCells(const StructureSurface& surface, int threads)
    : surface_(surface),
      threads_(threads),
      margin_(cutting::rounding_of(surface.surface.vertices)) {
    for (const cutting::CutterSurface& single : surface.single)
        singles_.push_back({spatial::BoxTree(boxes_of(single)), cutting::NearestSide(single)});
}

std::vector<std::uint8_t> NearCells::places_of(const ComplexView& model, const Sides& sides,
                                               const Progress* progress) const {
    // wider than what the overlay takes for near: faces of the other cells are left alone by it
    const double margin = 16 * std::max(margin_, cutting::rounding_of(positions_of(model)));
    std::vector<Box> boxes(model.cell_count());
    std::vector<std::int32_t> vertex(model.cell_count(), -1);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        Box box;
        for (const std::int32_t v : model.face(f))
            box.include(model.vertex(v));
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) < 0) continue;
            boxes[index(model.cell(f, k))].include(box);
            vertex[index(model.cell(f, k))] = model.face(f)[0];
        }
    }
    for (Box& box : boxes)
        box.widen(margin);
    std::vector<std::uint8_t> place(boxes.size(), kInside), near;
    for (std::size_t s = 0; s < sides.size(); ++s) {
        const auto& [tree, side] = singles_[s];
        const cutting::CutterSurface& surface = surface_.single[s];
        near.assign(boxes.size(), 0);
        parallel_ranges(
            boxes.size(), 1 << 12, threads_, progress,
            [&, &of = tree](std::size_t begin, std::size_t end) {
                for (std::size_t c = begin; c < end; ++c) {
                    if (place[c] == kElsewhere) continue;
                    of.find(boxes[c], [&](std::int32_t t) {
                        if (near[c] == 0 && plane_meets(corners_of(surface, index(t)), boxes[c]))
                            near[c] = 1;
                    });
                }
            });
        if (sides[s] == 0) {  // either side will do
            for (std::size_t c = 0; c < place.size(); ++c) {
                if (near[c] != 0) place[c] = kNear;
            }
            continue;
        }
        // what is connected beside the structure is on one side of it
        DisjointSets joined(boxes.size());
        const auto is_beside = [&](std::int32_t c) {
            return c >= 0 && place[index(c)] != kElsewhere && near[index(c)] == 0;
        };
        for (std::size_t f = 0; f < model.face_count(); ++f) {
            poll(progress, f);
            if (is_beside(model.cell(f, 0)) && is_beside(model.cell(f, 1)))
                joined.join(model.cell(f, 0), model.cell(f, 1));
        }
        std::vector<std::int8_t> known(boxes.size(), cutting::kOn);
        for (std::int32_t c = 0; index(c) < boxes.size(); ++c) {
            if (near[index(c)] != 0) place[index(c)] = kNear;
            if (!is_beside(c) || vertex[index(c)] < 0) continue;
            auto& own = known[index(joined.find(c))];
            if (own == cutting::kOn) {
                const Position p = model.vertex(vertex[index(c)]);
                own = surface.is_closed ? side.within(p) : side(p);
            }
            if (own != sides[s]) place[index(c)] = kElsewhere;
        }
    }
    return place;
}

}  // namespace realmodel::structures
