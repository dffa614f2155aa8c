// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/flat_mesh.hpp"

#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {

std::int32_t FlatMesh::add_triangle(const std::array<std::int32_t, 3>& corner) {
    corners.push_back(corner);
    across.emplace_back();
    fixed.push_back(0);
    return static_cast<std::int32_t>(corners.size()) - 1;
}

void FlatMesh::join(Side a, Side b) {
    across[a.triangle()][a.number()] = b;
    if (!b.is_outside()) across[b.triangle()][b.number()] = a;
}

void FlatMesh::fix(Side side, bool value) {
    const auto bit = static_cast<std::uint8_t>(1 << side.number());
    std::uint8_t& bits = fixed[side.triangle()];
    bits = static_cast<std::uint8_t>(value ? bits | bit : bits & ~bit);
}

Side FlatMesh::flip(Side side) {
    // a is right of the diagonal p-q, b left of it; the new diagonal goes from b's apex to a's.
    const Side other = behind(side);
    const std::int32_t t = side.triangle(), u = other.triangle();
    const std::int32_t p = from(side), q = to(side), left = apex(side), right = apex(other);
    const Side t_next = behind(side.next()), t_previous = behind(side.previous());
    const Side u_next = behind(other.next()), u_previous = behind(other.previous());
    const bool f_t_next = is_fixed(side.next()), f_t_previous = is_fixed(side.previous());
    const bool f_u_next = is_fixed(other.next()), f_u_previous = is_fixed(other.previous());

    corners[t] = {right, left, p};
    corners[u] = {left, right, q};
    fixed[t] = static_cast<std::uint8_t>((f_t_previous ? 2 : 0) | (f_u_next ? 4 : 0));
    fixed[u] = static_cast<std::uint8_t>((f_u_previous ? 2 : 0) | (f_t_next ? 4 : 0));
    join({t, 0}, {u, 0});
    join({t, 1}, t_previous);
    join({t, 2}, u_next);
    join({u, 1}, u_previous);
    join({u, 2}, t_next);
    return {t, 0};
}

bool FlatMesh::should_flip(Side side) const {
    const Side other = behind(side);
    return !other.is_outside() && !is_fixed(side) &&
           side_of_circle(point_from(side), point_to(side), point_apex(side), point_apex(other)) >
               0;
}

void FlatMesh::legalise(std::vector<Side>& doubtful) {
    while (!doubtful.empty()) {
        const Side side = doubtful.back();
        doubtful.pop_back();
        if (!should_flip(side)) continue;
        const Side diagonal = flip(side);
        const Side other = behind(diagonal);
        for (const Side s : {diagonal.next(), diagonal.previous(), other.next(), other.previous()})
            doubtful.push_back(s);
    }
}

/// Of a new vertex only the sides opposite to it can be wrong; each flip brings two more of them.
Side FlatMesh::legalise_around(std::int32_t vertex, std::int32_t triangle) {
    while (!doubtful_.empty()) {
        const Side side = doubtful_.back();
        doubtful_.pop_back();
        if (!should_flip(side)) continue;
        const Side diagonal = flip(side);  // from the apex beyond to the vertex
        doubtful_.push_back(diagonal.previous());
        doubtful_.push_back(behind(diagonal).next());
    }
    int number = 0;
    while (corners[triangle][number] != vertex)
        ++number;
    return {triangle, number};
}

Side FlatMesh::insert_inside(std::int32_t triangle, const PlanPoint& p) {
    const auto vertex = static_cast<std::int32_t>(points.size());
    points.push_back(p);
    const auto [a, b, c] = corners[triangle];
    const Side bc = across[triangle][1], ca = across[triangle][2];
    const std::uint8_t bits = fixed[triangle];
    const std::int32_t second = add_triangle({b, c, vertex});
    const std::int32_t third = add_triangle({c, a, vertex});
    corners[triangle] = {a, b, vertex};
    fixed[triangle] = bits & 1;
    fixed[second] = bits >> 1 & 1;
    fixed[third] = bits >> 2 & 1;
    join({second, 0}, bc);
    join({third, 0}, ca);
    join({triangle, 1}, {second, 2});
    join({second, 1}, {third, 2});
    join({third, 1}, {triangle, 2});
    doubtful_.assign({Side(triangle, 0), Side(second, 0), Side(third, 0)});
    return legalise_around(vertex, triangle);
}

Side FlatMesh::insert_on(Side side, const PlanPoint& p) {
    const auto vertex = static_cast<std::int32_t>(points.size());
    points.push_back(p);
    const Side other = behind(side);
    const bool is_kept = is_fixed(side);
    const auto split = [&](Side s) {  // its triangle keeps the first part, a new one takes the rest
        const std::int32_t a = from(s), b = to(s), c = apex(s), t = s.triangle();
        const Side bc = behind(s.next()), ca = behind(s.previous());
        const bool bc_fixed = is_fixed(s.next()), ca_fixed = is_fixed(s.previous());
        const std::int32_t rest = add_triangle({vertex, b, c});
        corners[t] = {a, vertex, c};
        fixed[t] = static_cast<std::uint8_t>((is_kept ? 1 : 0) | (ca_fixed ? 4 : 0));
        fixed[rest] = static_cast<std::uint8_t>((is_kept ? 1 : 0) | (bc_fixed ? 2 : 0));
        join({t, 2}, ca);
        join({rest, 1}, bc);
        join({t, 1}, {rest, 2});
        doubtful_.push_back({t, 2});
        doubtful_.push_back({rest, 1});
        return rest;
    };
    doubtful_.clear();
    const std::int32_t triangle = side.triangle();
    const std::int32_t rest = split(side);
    if (other.is_outside()) {
        join({triangle, 0}, Side::outside());
        join({rest, 0}, Side::outside());
    } else {
        const std::int32_t other_rest = split(other);
        join({triangle, 0}, {other_rest, 0});
        join({rest, 0}, {other.triangle(), 0});
    }
    return legalise_around(vertex, triangle);
}

std::array<Side, 2> FlatMesh::collapse(Side side) {
    const Side other = behind(side);
    const std::int32_t kept = to(side);
    Side around = side;
    do {
        corners[around.triangle()][around.number()] = kept;
        around = turn_left(around);
    } while (around != side);
    const auto close = [&](Side outer, Side inner) {
        // What lay behind the triangle's two other sides now meets; the outer one may be fixed.
        const Side beyond = behind(outer), stays = behind(inner);
        const bool is_kept = is_fixed(outer);
        join(stays, beyond);
        fix(stays, is_kept);
        if (!beyond.is_outside()) fix(beyond, is_kept);
        return stays;
    };
    const Side left = close(side.next(), side.previous());
    const Side right = close(other.previous(), other.next());
    for (const std::int32_t t : {side.triangle(), other.triangle()}) {
        corners[t] = {-1, -1, -1};
        across[t] = {};
        fixed[t] = 0;
    }
    return {left, right};
}

Side FlatMesh::pass_by(Side side) {
    const Side kept = side.previous(), gone = behind(kept), outer = gone.next();
    const Side beyond = behind(outer);
    corners[side.triangle()][side.number()] = to(outer);
    join(kept, beyond);
    fix(kept, is_fixed(outer));
    const std::int32_t dead = gone.triangle();
    corners[dead] = {-1, -1, -1};
    across[dead] = {};
    fixed[dead] = 0;
    return side;
}

void FlatMesh::compact() {
    const auto count = static_cast<std::int32_t>(corners.size());
    std::int32_t first = 0;
    while (first < count && !is_dead(first))
        ++first;
    if (first == count) return;
    std::vector<std::int32_t> number(count - first, -1);
    std::int32_t kept = first;
    for (std::int32_t t = first; t < count; ++t)
        if (!is_dead(t)) number[t - first] = kept++;
    for (std::int32_t t = 0; t < count; ++t) {
        if (is_dead(t)) continue;
        for (Side& side : across[t]) {
            if (!side.is_outside() && side.triangle() >= first) {
                side = {number[side.triangle() - first], side.number()};
            }
        }
        if (t < first) continue;
        const std::int32_t to = number[t - first];
        corners[to] = corners[t];
        across[to] = across[t];
        fixed[to] = fixed[t];
    }
    corners.resize(kept);
    across.resize(kept);
    fixed.resize(kept);
}

}  // namespace realmodel::meshing
