// SPDX-License-Identifier: GPL-3.0-or-later
// A surface as a user gives it, made ready to cut: repeated triangles, borders that run along one
// another, orientation, a seam beyond the border.
#include <algorithm>
#include <cmath>
#include <map>

#include "cutting/cutter_surface.hpp"
#include "exact/orient2d.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

using spatial::Box;
using spatial::BoxTree;

namespace {

using Triangle = std::array<std::int32_t, 3>;
using Edge = std::array<NodeId, 2>;

/// Triangles of a surface, and the number that each had in the input.
class SurfaceInput {
public:
    explicit SurfaceInput(const TriangleView& given);
    CutterSurface ready(bool with_seam) &&;

private:
    Position at(NodeId v) const { return surface_.vertices[index(v)]; }
    std::map<Edge, std::vector<std::int32_t>> by_edge() const;
    bool drop_repeated();
    void divide_borders();
    void divide_triangle(std::size_t t, const std::map<Edge, std::vector<NodeId>>& on_edge);
    bool runs(std::int32_t t, NodeId a, NodeId b) const;
    void reverse(std::int32_t t);
    bool orient_as_first(std::vector<std::int32_t>& part, std::vector<bool>& done,
                         const std::map<Edge, std::vector<std::int32_t>>& users_of);
    void orient_upward();
    void extend_border();

    CutterSurface surface_;
    std::vector<std::int64_t> original_;
};

SurfaceInput::SurfaceInput(const TriangleView& given) {
    const std::int32_t count =
        checked_number(given.vertices.size() / 3, "vertices of the surface that is to cut");
    checked_number(given.triangles.size(), "corners of the surface that is to cut");
    std::map<Position, NodeId> same;
    std::vector<NodeId> first;
    for (std::int32_t v = 0; v < count; ++v) {
        Position p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = given.vertices[3 * index(v) + k] + 0.0;  // both zeros alike
            if (!std::isfinite(p[k]))
                throw InputError("not_finite", "a vertex of the surface is not finite", -1, {v});
        }
        surface_.vertices.push_back(p);
        first.push_back(same.try_emplace(p, v).first->second);
    }
    for (std::size_t t = 0; t + 2 < given.triangles.size(); t += 3) {
        Triangle corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t v = given.triangles[t + i];
            if (v < 0 || v >= count)
                throw InputError("bad_index", "a triangle of the surface names no vertex", -1,
                                 {static_cast<std::int64_t>(t / 3)});
            corners[i] = first[index(v)];
        }
        if (in_one_line(at(corners[0]), at(corners[1]), at(corners[2]))) continue;
        surface_.triangles.push_back(corners);
        original_.push_back(static_cast<std::int64_t>(t / 3));
    }
    if (surface_.triangles.empty())
        throw InputError("no_triangles",
                         "the surface that is to cut has no triangles with an area");
}

std::map<Edge, std::vector<std::int32_t>> SurfaceInput::by_edge() const {
    std::map<Edge, std::vector<std::int32_t>> users;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        const Triangle& c = surface_.triangles[t];
        for (std::size_t i = 0; i < 3; ++i) {
            const NodeId a = c[i], b = c[(i + 1) % 3];
            users[unordered(a, b)].push_back(static_cast<std::int32_t>(t));
        }
    }
    return users;
}

/// Where leaving out pairs of equal triangles leaves a closed surface: does that, and true. Else
/// leaves one of each.
bool SurfaceInput::drop_repeated() {
    std::map<Triangle, std::vector<std::size_t>> equal;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        Triangle key = surface_.triangles[t];
        std::sort(key.begin(), key.end());
        equal[key].push_back(t);
    }
    std::map<Edge, int> users;
    bool any = false;
    for (const auto& [key, numbers] : equal) {
        if (numbers.size() % 2 == 0) continue;
        any = true;
        for (const Edge& edge : {Edge{key[0], key[1]}, Edge{key[1], key[2]}, Edge{key[0], key[2]}})
            ++users[edge];
    }
    const bool closed = any && std::all_of(users.begin(), users.end(),
                                           [](const auto& e) { return e.second % 2 == 0; });
    std::vector<std::size_t> kept;
    for (const auto& [key, numbers] : equal) {
        if (!closed || numbers.size() % 2 == 1) kept.push_back(numbers[0]);
    }
    std::sort(kept.begin(), kept.end());
    std::vector<Triangle> triangles;
    std::vector<std::int64_t> original;
    for (const std::size_t t : kept) {
        triangles.push_back(surface_.triangles[t]);
        original.push_back(original_[t]);
    }
    surface_.triangles = std::move(triangles);
    original_ = std::move(original);
    return closed;
}

/// Divides border edges at the corners of other borders that lie on them, or do but for rounding.
void SurfaceInput::divide_borders() {
    std::vector<Edge> edges;
    std::vector<Box> boxes;
    std::vector<NodeId> corners;
    for (const auto& [edge, users] : by_edge()) {
        if (users.size() != 1) continue;
        edges.push_back(edge);
        Box& box = boxes.emplace_back();
        for (const NodeId v : edge) {
            corners.push_back(v);
            box.include(at(v));
        }
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    const BoxTree tree(boxes);
    std::map<Edge, std::vector<std::pair<double, NodeId>>> found;
    for (const NodeId v : corners) {
        const Position p = at(v);
        const double tolerance = rounding_of(std::span(&p, 1));
        Box box;
        box.include(p);
        box.widen(tolerance);
        tree.find(box, [&](std::int32_t e) {
            const Edge& edge = edges[index(e)];
            if (v == edge[0] || v == edge[1]) return;
            const Position a = at(edge[0]), line = minus(at(edge[1]), a), off = minus(p, a);
            const double share = dot(off, line) / dot(line, line);
            if (!(share > 0 && share < 1)) return;
            for (std::size_t k = 0; k < 3; ++k) {
                if (std::abs(off[k] - share * line[k]) > tolerance) return;
            }
            found[edge].push_back({share, v});
        });
    }
    if (found.empty()) return;
    std::map<Edge, std::vector<NodeId>> on_edge;
    for (auto& [edge, corners_on_it] : found) {
        std::sort(corners_on_it.begin(), corners_on_it.end());
        for (const auto& [share, v] : corners_on_it)
            on_edge[edge].push_back(v);
    }
    const std::size_t count = surface_.triangles.size();
    for (std::size_t t = 0; t < count; ++t)
        divide_triangle(t, on_edge);
}

void SurfaceInput::divide_triangle(std::size_t t,
                                   const std::map<Edge, std::vector<NodeId>>& on_edge) {
    const Triangle corners = surface_.triangles[t];
    const std::array positions{at(corners[0]), at(corners[1]), at(corners[2])};
    const View view(polygon_normal(positions));
    Loop loop;
    for (std::size_t i = 0; i < 3; ++i) {
        const NodeId a = corners[i], b = corners[(i + 1) % 3];
        loop.push_back({a, view(at(a))});
        const auto found = on_edge.find(unordered(a, b));
        if (found == on_edge.end()) continue;
        std::vector<NodeId> between = found->second;
        if (a > b) std::reverse(between.begin(), between.end());
        for (const NodeId v : between)
            loop.push_back({v, view(at(v))});
    }
    if (loop.size() == 3) return;
    std::vector<std::array<LoopCorner, 3>> triangles;
    triangulate(std::span(&loop, 1), view.rounding(positions), triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto& own = triangles[i];
        const Triangle part{own[0].node, own[1].node, own[2].node};
        if (i == 0) {
            surface_.triangles[t] = part;
        } else {
            surface_.triangles.push_back(part);
            original_.push_back(original_[t]);
        }
    }
}

/// Whether a triangle's outline runs from a to b.
bool SurfaceInput::runs(std::int32_t t, NodeId a, NodeId b) const {
    const Triangle& c = surface_.triangles[index(t)];
    return (c[0] == a && c[1] == b) || (c[1] == a && c[2] == b) || (c[2] == a && c[0] == b);
}

void SurfaceInput::reverse(std::int32_t t) {
    std::swap(surface_.triangles[index(t)][1], surface_.triangles[index(t)][2]);
}

/// Gives all triangles that are connected with the first of a part its orientation, and adds them.
/// @return whether the part is closed
bool SurfaceInput::orient_as_first(std::vector<std::int32_t>& part, std::vector<bool>& done,
                                   const std::map<Edge, std::vector<std::int32_t>>& users_of) {
    bool closed = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
        const Triangle corners = surface_.triangles[index(part[i])];
        for (std::size_t k = 0; k < 3; ++k) {
            const NodeId a = corners[k], b = corners[(k + 1) % 3];
            const auto& users = users_of.at(unordered(a, b));
            closed = closed && users.size() == 2;
            for (const std::int32_t other : users) {
                if (other == part[i]) continue;
                if (done[index(other)]) {
                    if (!runs(other, a, b)) continue;
                    throw InputError("one_sided", "the surface has no two sides", -1,
                                     {original_[index(part[i])], original_[index(other)]}, at(a));
                }
                if (runs(other, a, b)) reverse(other);
                done[index(other)] = true;
                part.push_back(other);
            }
        }
    }
    return closed;
}

/// Orients each connected part of an open surface: upward on the whole, outward if closed.
void SurfaceInput::orient_upward() {
    const auto users_of = by_edge();
    for (const auto& [edge, users] : users_of) {
        if (users.size() < 3) continue;
        throw InputError(
            "branching", "more than two triangles of the surface share an edge", -1,
            {original_[index(users[0])], original_[index(users[1])], original_[index(users[2])]},
            at(edge[0]));
    }
    std::vector<bool> done(surface_.triangles.size(), false);
    for (std::int32_t start = 0; index(start) < done.size(); ++start) {
        if (done[index(start)]) continue;
        std::vector<std::int32_t> part{start};
        done[index(start)] = true;
        const bool closed = orient_as_first(part, done, users_of);
        double upward = 0, volume = 0;
        const Position origin = at(surface_.triangles[index(start)][0]);
        for (const std::int32_t t : part) {
            const Triangle& c = surface_.triangles[index(t)];
            const std::array corners{at(c[0]), at(c[1]), at(c[2])};
            const Position normal = polygon_normal(corners);
            upward += normal[2];
            volume += dot(normal, minus(corners[0], origin));
        }
        if ((closed ? volume : upward) >= 0) continue;
        for (const std::int32_t t : part)
            reverse(t);
    }
}

/// Adds a seam around an open surface, as wide as rounding may move things a hundred times over: a
/// surface that ends on the outside of a model then ends beyond it, whichever way that was rounded.
void SurfaceInput::extend_border() {
    const std::vector<CutterBorderEdge> border = border_of(surface_);
    const double width = 256 * rounding_of(surface_.vertices);
    std::map<NodeId, Position> outward;
    for (const CutterBorderEdge& edge : border) {
        const Position away = away_from(surface_, edge);
        for (const NodeId v : {edge.from, edge.to}) {
            Position& sum = outward.try_emplace(v, Position{0, 0, 0}).first->second;
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += away[k];
        }
    }
    std::map<NodeId, NodeId> beyond;
    for (const auto& [v, way] : outward) {
        const double size = length(way);
        if (size < 0.1) continue;  // the border runs back: it is a slit there
        Position p = surface_.vertices[index(v)];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] += width * way[k] / size;
        beyond[v] = static_cast<NodeId>(surface_.vertices.size());
        surface_.vertices.push_back(p);
    }
    for (const auto& [a, b, c] : border) {
        const auto at_a = beyond.find(a), at_b = beyond.find(b);
        if (at_a != beyond.end()) surface_.triangles.push_back({b, a, at_a->second});
        if (at_b != beyond.end())
            surface_.triangles.push_back(
                {b, at_a == beyond.end() ? a : at_a->second, at_b->second});
    }
}

CutterSurface SurfaceInput::ready(bool with_seam) && {
    surface_.is_closed = drop_repeated();
    if (!surface_.is_closed) {
        divide_borders();
        surface_.is_closed = drop_repeated();
    }
    if (!surface_.is_closed) {
        orient_upward();
        if (with_seam) extend_border();
    }
    return std::move(surface_);
}

}  // namespace

bool in_one_line(const Position& a, const Position& b, const Position& c) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
        if (exact::orient2d({a[k], a[l]}, {b[k], b[l]}, {c[k], c[l]}) != 0) return false;
    }
    return true;
}

CutterSurface oriented_surface(const TriangleView& given, bool with_seam) {
    return SurfaceInput(given).ready(with_seam);
}

}  // namespace realmodel::cutting
