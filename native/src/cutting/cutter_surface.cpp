// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_surface.hpp"

#include <algorithm>

#include "cutting/plane_edges.hpp"
#include "cutting/triangulate.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

namespace {

/// The point of a triangle that is nearest to p (C. Ericson, "Real-time collision detection", 2005,
/// section 5.1.5).
Position nearest_in_triangle(const Position& p, const Position& a, const Position& b,
                             const Position& c) {
    const auto along = [](const Position& from, const Position& line, double share) {
        return Position{from[0] + share * line[0], from[1] + share * line[1],
                        from[2] + share * line[2]};
    };
    const Position ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Position bp = minus(p, b);
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
    const Position cp = minus(p, c);
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return along(b, minus(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const double share = 1 / (va + vb + vc);
    return along(along(a, ab, vb * share), ac, vc * share);
}

}  // namespace

std::int8_t side_of_nearest(const CutterSurface& surface, const Position& p) {
    double least = HUGE_VAL, steepest = 0;
    std::int8_t side = kAbove;
    for (const auto& t : surface.triangles) {
        const std::array corners{surface.vertices[index(t[0])], surface.vertices[index(t[1])],
                                 surface.vertices[index(t[2])]};
        const Position away = minus(p, nearest_in_triangle(p, corners[0], corners[1], corners[2]));
        const double distance = dot(away, away);
        if (distance > least * (1 + 1e-9)) continue;
        // several triangles are equally near at their edge: the one seen most squarely decides
        const Position normal = polygon_normal(corners);
        const double square = dot(normal, away) / std::sqrt(std::max(dot(normal, normal), 1e-300));
        if (distance < least * (1 - 1e-9) || std::abs(square) > steepest) {
            steepest = std::abs(square);
            side = square < 0 ? kBelow : kAbove;
        }
        least = std::min(least, distance);
    }
    return side;
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
