// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutter_surface.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "plane_sides.hpp"
#include "realmodel/base/errors.hpp"
#include "triangulate.hpp"

namespace realmodel::cutting {

namespace {

Position minus(const Position& a, const Position& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Position& a, const Position& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The place of a triangle that is nearest to p (C. Ericson, "Real-time collision detection", 2005,
/// section 5.1.5).
Position nearest_in_triangle(const Position& p, const Position& a, const Position& b,
                             const Position& c) {
    const auto along = [](const Position& from, const Position& way, double share) {
        return Position{from[0] + share * way[0], from[1] + share * way[1],
                        from[2] + share * way[2]};
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

/// Adds a seam around an open surface, as wide as rounding may move things a hundred times over: a
/// surface that ends on the outside of a model then ends beyond it, whichever way that was rounded.
/// `border`: for each border edge, as its triangle turns, its ends and the third corner.
void extend_border(CutterSurface& surface, const std::vector<std::array<NodeId, 3>>& border) {
    const double width = 256 * rounding_of(surface.vertices);
    std::map<NodeId, Position> outward;
    for (const auto& [a, b, c] : border) {
        const Position o = surface.vertices[index(a)];
        const Position along = minus(surface.vertices[index(b)], o),
                       inward = minus(surface.vertices[index(c)], o);
        const double share = dot(inward, along) / dot(along, along);
        Position away;
        for (std::size_t k = 0; k < 3; ++k)
            away[k] = share * along[k] - inward[k];
        const double size = std::sqrt(dot(away, away));
        if (!(size > 0)) continue;
        for (const NodeId v : {a, b}) {
            Position& sum = outward.try_emplace(v, Position{0, 0, 0}).first->second;
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += away[k] / size;
        }
    }
    std::map<NodeId, NodeId> beyond;
    for (const auto& [v, way] : outward) {
        const double size = std::sqrt(dot(way, way));
        if (size < 0.1) continue;  // the border turns back: it is a slit there
        Position p = surface.vertices[index(v)];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] += width * way[k] / size;
        beyond[v] = static_cast<NodeId>(surface.vertices.size());
        surface.vertices.push_back(p);
    }
    for (const auto& [a, b, c] : border) {
        const auto at_a = beyond.find(a), at_b = beyond.find(b);
        if (at_a != beyond.end()) surface.triangles.push_back({b, a, at_a->second});
        if (at_b != beyond.end())
            surface.triangles.push_back({b, at_a == beyond.end() ? a : at_a->second, at_b->second});
    }
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
        // several triangles are equally near at their edge: the one seen most squarely tells
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

void triangulate_face(const ComplexView& model, std::size_t face,
                      std::vector<std::array<std::int32_t, 3>>& triangles) {
    const auto corners = model.face(face);
    triangles.clear();
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        return;
    }
    std::vector<Position> positions;
    for (const NodeId v : corners)
        positions.push_back(model.vertex(v));
    const View view(polygon_normal(positions));
    Loop loop;
    for (std::size_t i = 0; i < corners.size(); ++i)
        loop.push_back({corners[i], view(positions[i])});
    std::vector<std::array<LoopCorner, 3>> found;
    triangulate(std::span(&loop, 1), rounding_of(positions), found);
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
    if (surface.triangles.empty())
        throw InputError("no_block", "the block that is to cut has no cells", -1, {block});
    return surface;
}

CutterSurface oriented_surface(const TriangleView& given) {
    CutterSurface surface;
    const auto count = static_cast<std::int32_t>(given.vertices.size() / 3);
    for (std::int32_t v = 0; v < count; ++v) {
        const auto i = 3 * index(v);
        surface.vertices.push_back(
            {given.vertices[i], given.vertices[i + 1], given.vertices[i + 2]});
        for (const double x : surface.vertices.back()) {
            if (!std::isfinite(x))
                throw InputError("not_finite", "a vertex of the surface is not finite", -1, {v});
        }
    }
    std::map<Position, NodeId> same;
    std::vector<NodeId> first;
    for (std::int32_t v = 0; v < count; ++v)
        first.push_back(same.try_emplace(surface.vertices[index(v)], v).first->second);
    std::vector<std::int64_t> original;
    std::map<std::array<NodeId, 2>, std::vector<std::int32_t>> of_edge;
    for (std::size_t t = 0; t + 2 < given.triangles.size(); t += 3) {
        std::array<std::int32_t, 3> corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t v = given.triangles[t + i];
            if (v < 0 || v >= count)
                throw InputError("bad_index", "a triangle of the surface names no vertex", -1,
                                 {static_cast<std::int64_t>(t / 3)});
            corners[i] = first[index(v)];
        }
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2])
            continue;
        const auto number = static_cast<std::int32_t>(surface.triangles.size());
        surface.triangles.push_back(corners);
        original.push_back(static_cast<std::int64_t>(t / 3));
        for (std::size_t i = 0; i < 3; ++i) {
            const NodeId a = corners[i], b = corners[(i + 1) % 3];
            of_edge[{std::min(a, b), std::max(a, b)}].push_back(number);
        }
    }
    if (surface.triangles.empty())
        throw InputError("no_triangles", "the surface that is to cut has no triangles");
    const auto place = [&](NodeId v) { return surface.vertices[index(v)]; };
    for (const auto& [edge, users] : of_edge) {
        if (users.size() < 3) continue;
        throw InputError(
            "branching", "more than two triangles of the surface share an edge", -1,
            {original[index(users[0])], original[index(users[1])], original[index(users[2])]},
            place(edge[0]));
    }
    const auto runs = [&](std::int32_t t, NodeId a, NodeId b) {
        const auto& c = surface.triangles[index(t)];
        for (std::size_t i = 0; i < 3; ++i) {
            if (c[i] == a && c[(i + 1) % 3] == b) return true;
        }
        return false;
    };
    std::vector<bool> done(surface.triangles.size(), false);
    for (std::size_t start = 0; start < done.size(); ++start) {
        if (done[start]) continue;
        std::vector<std::int32_t> part{static_cast<std::int32_t>(start)};
        done[start] = true;
        bool closed = true;
        for (std::size_t i = 0; i < part.size(); ++i) {
            const auto corners = surface.triangles[index(part[i])];
            for (std::size_t k = 0; k < 3; ++k) {
                const NodeId a = corners[k], b = corners[(k + 1) % 3];
                const auto& users = of_edge.at({std::min(a, b), std::max(a, b)});
                closed = closed && users.size() == 2;
                for (const std::int32_t other : users) {
                    if (other == part[i]) continue;
                    if (done[index(other)]) {
                        if (!runs(other, a, b)) continue;
                        throw InputError("one_sided", "the surface has no two sides", -1,
                                         {original[index(part[i])], original[index(other)]},
                                         place(a));
                    }
                    if (runs(other, a, b))
                        std::swap(surface.triangles[index(other)][1],
                                  surface.triangles[index(other)][2]);
                    done[index(other)] = true;
                    part.push_back(other);
                }
            }
        }
        double upward = 0, volume = 0;
        const Position origin = place(surface.triangles[start][0]);
        for (const std::int32_t t : part) {
            const auto& c = surface.triangles[index(t)];
            const std::array corners{place(c[0]), place(c[1]), place(c[2])};
            const Position normal = polygon_normal(corners);
            upward += normal[2];
            volume += dot(normal, minus(corners[0], origin));
        }
        if ((closed ? volume : upward) >= 0) continue;
        for (const std::int32_t t : part)
            std::swap(surface.triangles[index(t)][1], surface.triangles[index(t)][2]);
    }
    std::vector<std::array<NodeId, 3>> border;
    for (const auto& [edge, users] : of_edge) {
        if (users.size() != 1) continue;
        const auto& t = surface.triangles[index(users[0])];
        std::size_t i = 0;
        while (std::min(t[i], t[(i + 1) % 3]) != edge[0] ||
               std::max(t[i], t[(i + 1) % 3]) != edge[1])
            ++i;
        border.push_back({t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
    }
    extend_border(surface, border);
    return surface;
}

}  // namespace realmodel::cutting
