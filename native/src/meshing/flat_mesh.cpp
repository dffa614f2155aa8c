// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/flat_mesh.hpp"

#include <cassert>
#include <utility>

#include "base/counting_sort.hpp"
#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {

FlatMesh::FlatMesh(PlanarMesh mesh)
    : points(std::move(mesh.vertices)), corners(std::move(mesh.triangles)) {
    assert(static_cast<double>(corners.size()) < kMostFlatTriangles);
    link();
}

void FlatMesh::link() {
    const auto leaving = bucketize<HalfEdge>(points.size(), [&](const auto& put) {
        for_each_edge([&](HalfEdge edge) { put(static_cast<std::size_t>(from(edge)), edge); });
    });
    twins.assign(corners.size(), {});
    marks.assign(corners.size(), 0);
    for_each_edge([&](HalfEdge edge) {
        if (!twin(edge).is_none()) return;
        const auto at_begin = leaving[static_cast<std::size_t>(from(edge))],
                   at_end = leaving[static_cast<std::size_t>(to(edge))];
        const bool from_end = at_end.size() <= at_begin.size();  // fans have many edges at one end
        for (const HalfEdge around : from_end ? at_end : at_begin) {
            const HalfEdge other = from_end ? around : around.prev();
            if (from(other) != to(edge) || to(other) != from(edge) || !twin(other).is_none())
                continue;
            join(edge, other);
            break;
        }
    });
}

std::int32_t FlatMesh::add_triangle(const std::array<std::int32_t, 3>& corner) {
    assert(static_cast<double>(corners.size()) < kMostFlatTriangles);
    corners.push_back(corner);
    twins.emplace_back();
    marks.push_back(0);
    return static_cast<std::int32_t>(corners.size()) - 1;
}

void FlatMesh::join(HalfEdge a, HalfEdge b) {
    twins[a.triangle()][a.index()] = b;
    if (!b.is_none()) twins[b.triangle()][b.index()] = a;
}

void FlatMesh::fix(HalfEdge edge, bool is_fixed, bool is_locked) {
    std::uint8_t& bits = marks[edge.triangle()];
    const int fixed_bit = 1 << edge.index(), locked_bit = 8 << edge.index();
    bits = static_cast<std::uint8_t>((bits & ~(fixed_bit | locked_bit)) |
                                     (is_fixed ? fixed_bit : 0) | (is_locked ? locked_bit : 0));
}

void FlatMesh::attach(HalfEdge edge, const OuterEdge& outer) {
    join(edge, outer.twin);
    fix(edge, outer.is_fixed, outer.is_locked);
}

void FlatMesh::kill(std::int32_t triangle) {
    corners[triangle] = {-1, -1, -1};
    twins[triangle] = {};
    marks[triangle] = 0;
}

HalfEdge FlatMesh::flip(HalfEdge edge) {
    // The diagonal p-q has `left` and `right` beside it; the new one goes from right to left.
    const HalfEdge other = twin(edge);
    assert(!other.is_none() && !is_fixed(edge));
    const std::int32_t t = edge.triangle(), u = other.triangle();
    const std::int32_t p = from(edge), q = to(edge), left = apex(edge), right = apex(other);
    assert(points.empty() || orient2d(points[right], points[left], points[p]) > 0);
    assert(points.empty() || orient2d(points[left], points[right], points[q]) > 0);
    const OuterEdge t_next = outer(edge.next()), t_prev = outer(edge.prev());
    const OuterEdge u_next = outer(other.next()), u_prev = outer(other.prev());
    corners[t] = {right, left, p};
    corners[u] = {left, right, q};
    marks[t] = marks[u] = 0;
    join({t, 0}, {u, 0});
    attach({t, 1}, t_prev);
    attach({t, 2}, u_next);
    attach({u, 1}, u_prev);
    attach({u, 2}, t_next);
    return {t, 0};
}

bool FlatMesh::should_flip(HalfEdge edge) const {
    const HalfEdge other = twin(edge);
    return !other.is_none() && !is_fixed(edge) &&
           in_circle(origin_point(edge), target_point(edge), apex_point(edge), apex_point(other)) >
               0;
}

/// Of a new vertex only the edges opposite to it can be wrong; each flip brings two more of them.
HalfEdge FlatMesh::legalize_around(std::int32_t vertex, std::int32_t triangle) {
    while (!open_.empty()) {
        const HalfEdge edge = open_.back();
        open_.pop_back();
        if (!should_flip(edge)) continue;
        const HalfEdge diagonal = flip(edge);  // from the apex beyond to the vertex
        open_.push_back(diagonal.prev());
        open_.push_back(twin(diagonal).next());
    }
    int index = 0;
    while (corners[triangle][index] != vertex)
        ++index;
    return {triangle, index};
}

void FlatMesh::rotate(std::int32_t triangle, int first) {
    const auto old = corners[triangle];
    const std::array<OuterEdge, 3> beyond{outer({triangle, 0}), outer({triangle, 1}),
                                          outer({triangle, 2})};
    for (int i = 0; i < 3; ++i) {
        corners[triangle][i] = old[(first + i) % 3];
        attach({triangle, i}, beyond[(first + i) % 3]);
    }
}

void FlatMesh::divide(std::int32_t triangle, std::int32_t vertex) {
    const auto [a, b, c] = corners[triangle];
    const OuterEdge ab = outer({triangle, 0}), bc = outer({triangle, 1}), ca = outer({triangle, 2});
    const std::int32_t second = add_triangle({b, c, vertex});
    const std::int32_t third = add_triangle({c, a, vertex});
    corners[triangle] = {a, b, vertex};
    marks[triangle] = 0;
    attach({triangle, 0}, ab);
    attach({second, 0}, bc);
    attach({third, 0}, ca);
    join({triangle, 1}, {second, 2});
    join({second, 1}, {third, 2});
    join({third, 1}, {triangle, 2});
    open_.assign({HalfEdge(triangle, 0), HalfEdge(second, 0), HalfEdge(third, 0)});
}

HalfEdge FlatMesh::insert_inside(std::int32_t triangle, const PlanPoint& p) {
    const auto vertex = static_cast<std::int32_t>(points.size());
    points.push_back(p);
    divide(triangle, vertex);
    return legalize_around(vertex, triangle);
}

HalfEdge FlatMesh::insert_on(HalfEdge edge, const PlanPoint& p) {
    points.push_back(p);
    return insert_on(edge, static_cast<std::int32_t>(points.size()) - 1);
}

HalfEdge FlatMesh::insert_on(HalfEdge edge, std::int32_t vertex) {
    divide(edge, vertex);
    return legalize_around(vertex, edge.triangle());
}

void FlatMesh::divide(HalfEdge edge, std::int32_t vertex) {
    const HalfEdge other = twin(edge);
    const auto split = [&](HalfEdge e) {  // its triangle keeps the first part, a new one the rest
        const std::int32_t a = from(e), b = to(e), c = apex(e), t = e.triangle();
        const OuterEdge ab = outer(e), bc = outer(e.next()), ca = outer(e.prev());
        const std::int32_t rest = add_triangle({vertex, b, c});
        corners[t] = {a, vertex, c};
        marks[t] = 0;
        fix({t, 0}, ab.is_fixed, ab.is_locked);
        fix({rest, 0}, ab.is_fixed, ab.is_locked);
        attach({t, 2}, ca);
        attach({rest, 1}, bc);
        join({t, 1}, {rest, 2});
        open_.push_back({t, 2});
        open_.push_back({rest, 1});
        return rest;
    };
    open_.clear();
    const std::int32_t triangle = edge.triangle();
    const std::int32_t rest = split(edge);
    if (other.is_none()) {
        join({triangle, 0}, HalfEdge::none());
        join({rest, 0}, HalfEdge::none());
    } else {
        const std::int32_t other_rest = split(other);
        join({triangle, 0}, {other_rest, 0});
        join({rest, 0}, {other.triangle(), 0});
    }
}

std::array<HalfEdge, 2> FlatMesh::collapse(HalfEdge edge) {
    const HalfEdge other = twin(edge);
    const std::int32_t target = to(edge);
    HalfEdge around = edge;
    do {
        corners[around.triangle()][around.index()] = target;
        around = rotate_ccw(around);
    } while (around != edge);
    const auto close = [&](HalfEdge beyond_edge, HalfEdge inner) {
        // What lay beyond the triangle's two other edges now meets; the outer one may be fixed.
        const OuterEdge beyond = outer(beyond_edge);
        const HalfEdge stays = twin(inner);
        attach(stays, beyond);
        if (!beyond.twin.is_none()) fix(beyond.twin, beyond.is_fixed, beyond.is_locked);
        return stays;
    };
    const HalfEdge left = close(edge.next(), edge.prev());
    const HalfEdge right = close(other.prev(), other.next());
    kill(edge.triangle());
    kill(other.triangle());
    return {left, right};
}

HalfEdge FlatMesh::remove_from_border(HalfEdge edge) {
    const HalfEdge before = edge.prev(), gone = twin(before), beyond = gone.next();
    assert(is_border(edge) && is_border(gone.prev()));
    corners[edge.triangle()][edge.index()] = to(beyond);
    attach(before, outer(beyond));
    kill(gone.triangle());
    return edge;
}

void FlatMesh::compact() {
    const auto count = static_cast<std::int32_t>(corners.size());
    std::int32_t first = 0;
    while (first < count && !is_dead(first))
        ++first;
    if (first == count) return;
    std::vector<std::int32_t> number(count - first, -1);
    std::int32_t live_count = first;
    for (std::int32_t t = first; t < count; ++t)
        if (!is_dead(t)) number[t - first] = live_count++;
    for (std::int32_t t = 0; t < count; ++t) {
        if (is_dead(t)) continue;
        for (HalfEdge& edge : twins[t]) {
            if (!edge.is_none() && edge.triangle() >= first) {
                edge = {number[edge.triangle() - first], edge.index()};
            }
        }
        if (t < first) continue;
        const std::int32_t to = number[t - first];
        corners[to] = corners[t];
        twins[to] = twins[t];
        marks[to] = marks[t];
    }
    corners.resize(live_count);
    twins.resize(live_count);
    marks.resize(live_count);
}

}  // namespace realmodel::meshing
