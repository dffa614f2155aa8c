// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "arrangement/edge_fan.hpp"
#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/key_table.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

using arrangement::EdgeUses;
using spatial::Box;
using spatial::BoxTree;

std::vector<CutterBorderEdge> border_of(const Cutter& cutter) {
    const auto& triangles = cutter.triangles;
    const auto corners = [&](std::size_t t) -> const auto& {
        return triangles[t];
    };
    const auto edges = arrangement::edges_of(triangles.size(), cutter.vertices.size(), corners, {});
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

Position away_from(const Cutter& cutter, const CutterBorderEdge& edge) {
    const Position o = cutter.vertices[index(edge.from)];
    const Position along = minus(cutter.vertices[index(edge.to)], o);
    const Position inward = minus(cutter.vertices[index(edge.corner)], o);
    const double share = dot(inward, along) / dot(along, along);
    return unit(minus(times(share, along), inward));
}

Cutter block_boundary(const ComplexView& model, std::int32_t block) {
    Cutter cutter;
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
                    known = static_cast<NodeId>(cutter.vertices.size());
                    cutter.vertices.push_back(model.vertex(v));
                }
                v = known;
            }
            if (second) std::swap(t[1], t[2]);
            cutter.triangles.push_back(t);
        }
    }
    cutter.is_closed = true;
    if (cutter.triangles.empty())
        throw InputError("no_block", "the block that is to cut has no cells", -1, {block});
    return cutter;
}

// A surface as a user gives it, made ready to cut: repeated triangles, borders that run along one
// another, orientation, a seam beyond the border.

namespace {

using Triangle = std::array<std::int32_t, 3>;
using NodeEdge = std::array<NodeId, 2>;

/// Triangles of a surface, and the number that each had in the input.
class CutterInput {
public:
    explicit CutterInput(const TriangleView& input);
    Cutter ready(bool with_seam) &&;

private:
    Position at(NodeId v) const { return cutter_.vertices[index(v)]; }
    /// A corner of a border that lies on a border edge, at a share of its length.
    struct NodeOnEdge {
        NodeEdge edge;
        double share;
        NodeId node;
        auto operator<=>(const NodeOnEdge&) const = default;
    };

    EdgeUses edges_of(const std::vector<Triangle>& triangles) const;
    bool are_closed(const std::vector<Triangle>& triangles) const;
    bool drop_repeated();
    void divide_borders();
    void divide_triangle(std::size_t t, std::span<const NodeOnEdge> on_edges);
    bool runs(std::int32_t t, NodeId a, NodeId b) const;
    void reverse(std::int32_t t);
    bool orient_as_first(std::vector<std::int32_t>& component, std::vector<bool>& done,
                         const EdgeUses& edges);
    void orient_upward();
    Position beyond_tip(NodeId from, const CutterBorderEdge& next) const;
    void extend_border();

    Cutter cutter_;
    std::vector<std::int64_t> original_;
};

CutterInput::CutterInput(const TriangleView& input) {
    const std::int32_t count =
        checked_number(input.vertices.size() / 3, "vertices of the surface that is to cut");
    checked_number(input.triangles.size(), "corners of the surface that is to cut");
    KeyTable same;
    std::vector<NodeId> first;
    for (std::int32_t v = 0; v < count; ++v) {
        Position p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = input.vertices[3 * index(v) + k] + 0.0;  // both zeros alike
            if (!std::isfinite(p[k]))
                throw InputError("not_finite", "a vertex of the surface is not finite", -1, {v});
        }
        cutter_.vertices.push_back(p);
        const auto vertex =
            same.find_or_add(KeyTable::hash(std::bit_cast<std::array<std::uint64_t, 3>>(p)), v,
                             [&](NodeId other) { return at(other) == p; });
        first.push_back(vertex.number);
    }
    require_triangles(input.triangles, first.size());
    for (std::size_t t = 0; t + 2 < input.triangles.size(); t += 3) {
        Triangle corners{};
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = first[index(input.triangles[t + i])];
        if (exact::in_one_line(at(corners[0]), at(corners[1]), at(corners[2]))) continue;
        cutter_.triangles.push_back(corners);
        original_.push_back(static_cast<std::int64_t>(t / 3));
    }
    if (cutter_.triangles.empty())
        throw InputError("no_triangles",
                         "the surface that is to cut has no triangles with an area");
}

EdgeUses CutterInput::edges_of(const std::vector<Triangle>& triangles) const {
    return arrangement::edges_of(triangles.size(), cutter_.vertices.size(),
                                 [&](std::size_t t) -> const Triangle& { return triangles[t]; },
                                 {1});
}

/// Whether some triangles have each edge an even number of times.
bool CutterInput::are_closed(const std::vector<Triangle>& triangles) const {
    const EdgeUses edges = edges_of(triangles);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].size() % 2 != 0) return false;
    }
    return !triangles.empty();
}

/// Where leaving out pairs of equal triangles leaves a closed surface: does that, and true. Else
/// leaves one of each.
bool CutterInput::drop_repeated() {
    std::vector<std::pair<Triangle, std::size_t>> sorted;
    for (std::size_t t = 0; t < cutter_.triangles.size(); ++t) {
        sorted.push_back({cutter_.triangles[t], t});
        std::ranges::sort(sorted.back().first);
    }
    std::ranges::sort(sorted);
    std::vector<Triangle> odd;                // those that are there an odd number of times
    std::vector<std::size_t> all, remaining;  // the first of each, and of these
    for (const auto equal : groups_of(sorted, &std::pair<Triangle, std::size_t>::first)) {
        all.push_back(equal[0].second);
        if (equal.size() % 2 == 0) continue;
        odd.push_back(equal[0].first);
        remaining.push_back(equal[0].second);
    }
    const bool closed = are_closed(odd);
    if (!closed) remaining = std::move(all);
    std::ranges::sort(remaining);
    std::vector<Triangle> triangles;
    std::vector<std::int64_t> original;
    for (const std::size_t t : remaining) {
        triangles.push_back(cutter_.triangles[t]);
        original.push_back(original_[t]);
    }
    cutter_.triangles = std::move(triangles);
    original_ = std::move(original);
    return closed;
}

/// Divides border edges at the corners of other borders that lie on them, or do but for rounding.
void CutterInput::divide_borders() {
    std::vector<NodeEdge> edges;
    std::vector<Box> boxes;
    std::vector<NodeId> corners;
    const EdgeUses uses = edges_of(cutter_.triangles);
    for (std::size_t e = 0; e < uses.size(); ++e) {
        if (uses[e].size() != 1) continue;
        edges.push_back(uses.ends(e));
        corners.insert(corners.end(), edges.back().begin(), edges.back().end());
        boxes.push_back(spatial::bounding_box(edges.back(), [this](NodeId v) { return at(v); }));
    }
    sort_unique(corners);
    const BoxTree tree(boxes);
    std::vector<NodeOnEdge> on_edges;
    for (const NodeId v : corners) {
        const Position p = at(v);
        const double tolerance = rounding_of(std::span(&p, 1));
        Box box{p, p};
        box.widen(tolerance);
        tree.find(box, [&](std::int32_t e) {
            const NodeEdge& edge = edges[index(e)];
            if (v == edge[0] || v == edge[1]) return;
            const Position a = at(edge[0]), line = minus(at(edge[1]), a), off = minus(p, a);
            const double share = dot(off, line) / dot(line, line);
            if (!(share > 0 && share < 1)) return;
            for (std::size_t k = 0; k < 3; ++k) {
                if (std::abs(off[k] - share * line[k]) > tolerance) return;
            }
            on_edges.push_back({edge, share, v});
        });
    }
    if (on_edges.empty()) return;
    std::ranges::sort(on_edges);
    const std::size_t count = cutter_.triangles.size();
    for (std::size_t t = 0; t < count; ++t)
        divide_triangle(t, on_edges);
}

void CutterInput::divide_triangle(std::size_t t, std::span<const NodeOnEdge> on_edges) {
    const Triangle corners = cutter_.triangles[t];
    const std::array positions{at(corners[0]), at(corners[1]), at(corners[2])};
    const View view(polygon_normal(positions));
    Loop loop;
    for (std::size_t i = 0; i < 3; ++i) {
        const NodeId a = corners[i], b = corners[(i + 1) % 3];
        loop.push_back({a, view(at(a))});
        const std::size_t begin = loop.size();
        const auto edge = unordered(a, b);
        for (const NodeOnEdge& on : items_with_key(on_edges, edge, &NodeOnEdge::edge))
            loop.push_back({on.node, view(at(on.node))});
        if (a > b) std::reverse(loop.begin() + static_cast<std::ptrdiff_t>(begin), loop.end());
    }
    if (loop.size() == 3) return;
    std::vector<std::array<LoopCorner, 3>> triangles;
    triangulate(std::span(&loop, 1), view.rounding(positions), triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto& triangle = triangles[i];
        const Triangle piece{triangle[0].node, triangle[1].node, triangle[2].node};
        if (i == 0) {
            cutter_.triangles[t] = piece;
        } else {
            cutter_.triangles.push_back(piece);
            original_.push_back(original_[t]);
        }
    }
}

/// Whether a triangle's outline runs from a to b.
bool CutterInput::runs(std::int32_t t, NodeId a, NodeId b) const {
    const Triangle& c = cutter_.triangles[index(t)];
    return (c[0] == a && c[1] == b) || (c[1] == a && c[2] == b) || (c[2] == a && c[0] == b);
}

void CutterInput::reverse(std::int32_t t) {
    std::swap(cutter_.triangles[index(t)][1], cutter_.triangles[index(t)][2]);
}

/// Gives all triangles that are connected with the first of a part its orientation, and adds them.
/// @return whether the part is closed
bool CutterInput::orient_as_first(std::vector<std::int32_t>& component, std::vector<bool>& done,
                                  const EdgeUses& edges) {
    bool closed = true;
    for (std::size_t i = 0; i < component.size(); ++i) {
        const Triangle corners = cutter_.triangles[index(component[i])];
        for (std::size_t k = 0; k < 3; ++k) {
            const NodeId a = corners[k], b = corners[(k + 1) % 3];
            const auto uses = edges.between(unordered(a, b));
            closed = closed && uses.size() == 2;
            for (const arrangement::EdgeUse& use : uses) {
                const std::int32_t other = use.item;
                if (other == component[i]) continue;
                if (done[index(other)]) {
                    if (!runs(other, a, b)) continue;
                    throw InputError("one_sided", "the surface has no two sides", -1,
                                     {original_[index(component[i])], original_[index(other)]},
                                     at(a));
                }
                if (runs(other, a, b)) reverse(other);
                done[index(other)] = true;
                component.push_back(other);
            }
        }
    }
    return closed;
}

/// Orients each connected part of an open surface: upward on the whole, outward if closed.
void CutterInput::orient_upward() {
    const EdgeUses edges = edges_of(cutter_.triangles);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].size() < 3) continue;
        const auto row = [&](std::size_t i) { return original_[index(edges[e][i].item)]; };
        throw InputError("branching", "more than two triangles of the surface share an edge", -1,
                         {row(0), row(1), row(2)}, at(edges.ends(e)[0]));
    }
    std::vector<bool> done(cutter_.triangles.size(), false);
    for (std::int32_t start = 0; index(start) < done.size(); ++start) {
        if (done[index(start)]) continue;
        std::vector<std::int32_t> component{start};
        done[index(start)] = true;
        const bool closed = orient_as_first(component, done, edges);
        double upward = 0, volume = 0;
        const Position origin = at(cutter_.triangles[index(start)][0]);
        for (const std::int32_t t : component) {
            const Triangle& c = cutter_.triangles[index(t)];
            const std::array corners{at(c[0]), at(c[1]), at(c[2])};
            const Position normal = polygon_normal(corners);
            upward += normal[2];
            volume += dot(normal, minus(corners[0], origin));
        }
        if ((closed ? volume : upward) >= 0) continue;
        for (const std::int32_t t : component)
            reverse(t);
    }
}

/// Where the border turns back at a vertex, nearly into its own direction: the direction beyond it
/// of a tip, 0 where it is a slit.
Position CutterInput::beyond_tip(NodeId from, const CutterBorderEdge& next) const {
    const Position way = unit(minus(at(next.from), at(from))),
                   next_way = unit(minus(at(next.to), at(next.from)));
    const Position inward = minus(at(next.corner), at(next.from));
    const bool is_tip =
        next.corner == from || dot(cross(next_way, inward), cross(way, next_way)) > 0;
    return is_tip ? minus(way, next_way) : Position{};
}

/// Adds a seam around an open surface, as wide as rounding may move things a hundred times over: a
/// surface that ends on the outside of a model then ends beyond it, whichever way that was rounded.
void CutterInput::extend_border() {
    const std::vector<CutterBorderEdge> border = border_of(cutter_);
    const double width = 256 * rounding_of(cutter_.vertices);
    std::vector<Position> outward(cutter_.vertices.size(), Position{0, 0, 0});
    std::vector<std::vector<NodeId>> before(outward.size());  // along the border
    for (const CutterBorderEdge& edge : border) {
        const Position away = away_from(cutter_, edge);
        for (const NodeId v : {edge.from, edge.to})
            outward[index(v)] = plus(outward[index(v)], away);
        before[index(edge.to)].push_back(edge.from);
    }
    for (const CutterBorderEdge& edge : border) {
        const auto v = index(edge.from);
        if (length(outward[v]) < 0.1)
            outward[v] = before[v].size() == 1 ? beyond_tip(before[v][0], edge) : Position{};
    }
    std::vector<NodeId> beyond(outward.size(), -1);
    for (std::size_t v = 0; v < outward.size(); ++v) {
        const double size = length(outward[v]);
        if (size == 0) continue;
        Position p = cutter_.vertices[v];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] += width * outward[v][k] / size;
        beyond[v] = static_cast<NodeId>(cutter_.vertices.size());
        cutter_.vertices.push_back(p);
    }
    for (const auto& [a, b, c] : border) {
        const NodeId at_a = beyond[index(a)], at_b = beyond[index(b)];
        if (at_a >= 0) cutter_.triangles.push_back({b, a, at_a});
        if (at_b >= 0) cutter_.triangles.push_back({b, at_a < 0 ? a : at_a, at_b});
    }
}

Cutter CutterInput::ready(bool with_seam) && {
    cutter_.is_closed = drop_repeated();
    if (!cutter_.is_closed) {
        divide_borders();
        cutter_.is_closed = drop_repeated();
    }
    if (!cutter_.is_closed) {
        orient_upward();
        if (with_seam) extend_border();
    }
    return std::move(cutter_);
}

}  // namespace

Cutter oriented_cutter(const TriangleView& cutter, bool with_seam) {
    return CutterInput(cutter).ready(with_seam);
}

}  // namespace realmodel::cutting
