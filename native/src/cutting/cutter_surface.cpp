// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_surface.hpp"

#include "arrangement/edge_fan.hpp"
#include "base/lists.hpp"
#include "cutting/edge_intersections.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

std::vector<Position> positions_of(const ComplexView& model, std::span<const NodeId> polygon) {
    return mapped(polygon, [&](NodeId v) { return model.vertex(v); });
}

std::pair<Loop, PlanePosition> loop_of(const ComplexView& model, std::span<const NodeId> polygon) {
    const std::vector<Position> positions = positions_of(model, polygon);
    const View view(polygon_normal(positions));
    Loop loop;
    loop.reserve(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i)
        loop.push_back({polygon[i], view(positions[i])});
    return {std::move(loop), view.rounding(positions)};
}

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

std::vector<CutterBorderEdge> border_of(const CutterSurface& surface) {
    const auto& triangles = surface.triangles;
    const auto corners = [&](std::size_t t) -> const auto& {
        return triangles[t];
    };
    const auto edges =
        arrangement::edges_of(triangles.size(), surface.vertices.size(), corners, {});
    std::vector<CutterBorderEdge> border;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].size() % 2 == 0) continue;
        const auto& t = triangles[index(edges[e].back().item)];
        std::size_t i = 0;
        while (unordered(t[i], t[(i + 1) % 3]) != edges.ends(e))
            ++i;
        border.push_back({t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
    }
    return border;
}

Position away_from(const CutterSurface& surface, const CutterBorderEdge& edge) {
    const Position o = surface.vertices[index(edge.from)];
    const Position along = minus(surface.vertices[index(edge.to)], o);
    const Position inward = minus(surface.vertices[index(edge.corner)], o);
    const double share = dot(inward, along) / dot(along, along);
    return unit(minus(times(share, along), inward));
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
