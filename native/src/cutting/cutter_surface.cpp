// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_surface.hpp"

#include <algorithm>

#include "cutting/plane_edges.hpp"
#include "cutting/triangulate.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

void divide_face(const ComplexView& model, std::size_t face, Polygons& polygons) {
    const auto [loop, rounding] = loop_of(model, model.face(face));
    divide_convex(std::span(&loop, 1), rounding, {}, polygons);
}

void triangulate_face(const ComplexView& model, std::size_t face,
                      std::vector<std::array<std::int32_t, 3>>& triangles) {
    const auto corners = model.face(face);
    triangles.clear();
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        return;
    }
    const auto [loop, rounding] = loop_of(model, model.face(face));
    std::vector<std::array<LoopCorner, 3>> found;
    triangulate(std::span(&loop, 1), rounding, found);
    for (const auto& t : found)
        triangles.push_back({t[0].node, t[1].node, t[2].node});
}

std::optional<std::size_t> upright_sides(std::span<const NodeId> face, const ComplexView& model,
                                         std::vector<NodeId>& corners) {
    const std::size_t n = face.size();
    const auto at = [&](std::size_t i) { return model.vertex(face[i % n]); };
    const auto turns_at = [&](std::size_t i) {  // whether another line begins at a corner
        const Position p = at(i), before = at(i + n - 1);
        return p[0] != before[0] || p[1] != before[1];
    };
    std::size_t first = n, second = n, lines = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!turns_at(i)) continue;
        ++lines;
        (first == n ? first : second) = i;
    }
    if (lines != 2) return std::nullopt;
    // one side goes up and the other down
    int direction = 0;
    for (const auto& [begin, end] : {std::pair(first, second), std::pair(second, first + n)}) {
        for (std::size_t i = begin + 1; i < end; ++i) {
            const double step = at(i)[2] - at(i - 1)[2];
            if (step == 0 || (direction != 0 && (step > 0) != (direction > 0))) return std::nullopt;
            direction = step > 0 ? 1 : -1;
        }
        direction = -direction;
    }
    corners.clear();
    for (std::size_t i = first; i < first + n; ++i)
        corners.push_back(face[i % n]);
    return second - first;
}

CutterSurface block_boundary(const ComplexView& model, std::int32_t block) {
    CutterSurface surface;
    std::vector<NodeId> number(model.vertex_count(), -1);
    std::vector<std::array<std::int32_t, 3>> triangles;
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        const bool first = model.block(model.cell(f, 0)) == block;
        const bool second = model.block(model.cell(f, 1)) == block;
        if (first == second) continue;
        triangulate_face(model, f, triangles);
        for (auto t : triangles) {
            for (NodeId& v : t) {
                NodeId& known = number[index(v)];
                if (known < 0) {
                    known = static_cast<NodeId>(surface.vertices.size());
                    surface.vertices.push_back(model.vertex(v));
                }
                v = known;
            }
            if (second) std::swap(t[1], t[2]);
            surface.triangles.push_back(t);
        }
    }
    surface.is_closed = true;
    if (surface.triangles.empty())
        throw InputError("no_block", "the block that is to cut has no cells", -1, {block});
    return surface;
}

}  // namespace realmodel::cutting
