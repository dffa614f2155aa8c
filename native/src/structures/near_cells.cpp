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
    : surface_(surface), threads_(threads), tree_(boxes_of(surface.surface)) {
    for (const cutting::CutterSurface& single : surface.single)
        nearest_.emplace_back(single);
}

std::vector<std::uint8_t> NearCells::near(const ComplexView& model,
                                          const Progress* progress) const {
    std::vector<Box> boxes(model.cell_count());
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        Box box;
        for (const std::int32_t v : model.face(f))
            box.include(model.vertex(v));
        for (std::size_t k = 0; k < 2; ++k) {
            if (model.cell(f, k) >= 0) boxes[index(model.cell(f, k))].include(box);
        }
    }
    std::vector<std::uint8_t> found(boxes.size(), 0);
    parallel_ranges(boxes.size(), 1 << 12, threads_, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c) {
                            tree_.find(boxes[c], [&](std::int32_t t) {
                                if (found[c] == 0 &&
                                    plane_meets(corners_of(surface_.surface, index(t)), boxes[c]))
                                    found[c] = 1;
                            });
                        }
                    });
    return found;
}

bool NearCells::is_on(const Position& p, const Sides& sides) const {
    for (std::size_t s = 0; s < sides.size(); ++s) {
        if (sides[s] == 0) continue;
        const bool is_closed = surface_.single[s].is_closed;
        if ((is_closed ? nearest_[s].within(p) : nearest_[s](p)) != sides[s]) return false;
    }
    return true;
}

std::vector<std::uint8_t> NearCells::that_may_be_in(const ComplexView& model, const Sides& sides,
                                                    const Progress* progress) const {
    std::vector<std::uint8_t> wanted = near(model, progress);
    DisjointSets joined(model.cell_count());
    std::vector<std::int32_t> vertex(model.cell_count(), -1);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        const std::int32_t a = model.cell(f, 0), b = model.cell(f, 1);
        vertex[index(a)] = model.face(f)[0];
        if (b < 0) continue;
        vertex[index(b)] = model.face(f)[0];
        if (wanted[index(a)] == 0 && wanted[index(b)] == 0) joined.join(a, b);
    }
    std::vector<std::int8_t> known(model.cell_count(), -1);
    for (std::size_t c = 0; c < wanted.size(); ++c) {
        if (wanted[c] != 0 || vertex[c] < 0) continue;
        auto& is_wanted = known[index(joined.find(static_cast<std::int32_t>(c)))];
        if (is_wanted < 0) is_wanted = is_on(model.vertex(vertex[c]), sides) ? 1 : 0;
        wanted[c] = static_cast<std::uint8_t>(is_wanted);
    }
    return wanted;
}

}  // namespace realmodel::structures
