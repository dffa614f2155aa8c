// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/valences.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"

namespace realmodel::meshing {

namespace {

constexpr double least_ratio = 0.35;             // of triangles that flips and collapses make
constexpr double longest_after_collapse = 1.55;  // lengths wanted

}  // namespace

double mean_ratio(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    const double squares = squared_distance(a, b) + squared_distance(b, c) + squared_distance(c, a);
    return 2 * std::numbers::sqrt3 * twice_area(a, b, c) / squares;
}

Valences::Valences(FlatMesh& mesh, const SizeField& size) : mesh_(mesh), size_(size) {
    const std::size_t points = mesh.points.size();
    leaving_.resize(points);
    triangles_.assign(points, 0);
    wanted_.assign(points, 6);
    is_fixed_.assign(points, false);
    const auto count = static_cast<std::int32_t>(mesh_.corners.size());
    for (std::int32_t t = 0; t < count; ++t) {
        if (mesh_.is_dead(t)) continue;
        for (int i = 0; i < 3; ++i) {
            const Side side(t, i);
            const std::int32_t v = mesh_.from(side);
            leaving_[v] = side;
            ++triangles_[v];
            if (mesh_.is_fixed(side)) is_fixed_[v] = is_fixed_[mesh_.to(side)] = true;
        }
    }
    want_on_lines();
}

/// Each sector between two fixed sides wants triangles of 60 degrees.
void Valences::want_on_lines() {
    std::vector<bool> seen(mesh_.points.size(), false);
    const auto count = static_cast<std::int32_t>(mesh_.corners.size());
    for (std::int32_t t = 0; t < count; ++t) {
        if (mesh_.is_dead(t)) continue;
        for (int i = 0; i < 3; ++i) {
            const Side begin(t, i);
            if (!mesh_.is_fixed(begin)) continue;
            const std::int32_t v = mesh_.from(begin);
            if (!seen[v]) {
                seen[v] = true;
                wanted_[v] = 0;
            }
            double angle = 0;
            Side side = begin;
            while (true) {
                angle += angle_at(side);
                const Side last = side.previous();
                if (mesh_.is_fixed(last)) break;
                side = mesh_.turn_left(side);
            }
            wanted_[v] += std::max(1, static_cast<int>(std::lround(angle * 3 / std::numbers::pi)));
        }
    }
}

double Valences::angle_at(Side side) const {
    const PlanPoint &p = mesh_.point_from(side), &a = mesh_.point_to(side),
                    &b = mesh_.point_apex(side);
    const double ux = a[0] - p[0], uy = a[1] - p[1], vx = b[0] - p[0], vy = b[1] - p[1];
    return std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
}

int Valences::gain_of_flip(Side side) const {
    const std::int32_t a = mesh_.from(side), b = mesh_.to(side), c = mesh_.apex(side),
                       d = mesh_.apex(mesh_.behind(side));
    return strain(a, 0) + strain(b, 0) + strain(c, 0) + strain(d, 0) - strain(a, -1) -
           strain(b, -1) - strain(c, 1) - strain(d, 1);
}

bool Valences::can_flip(Side side) const {
    const std::int32_t a = mesh_.from(side), b = mesh_.to(side), c = mesh_.apex(side),
                       d = mesh_.apex(mesh_.behind(side));
    if ((triangles_[a] <= 3 && !is_fixed_[a]) || (triangles_[b] <= 3 && !is_fixed_[b])) {
        return false;
    }
    const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b], &l = mesh_.points[c],
                    &r = mesh_.points[d];
    return mean_ratio(r, l, p) >= least_ratio && mean_ratio(l, r, q) >= least_ratio &&
           side_of_line(r, l, p) > 0 && side_of_line(l, r, q) > 0;
}

Side Valences::flip(Side side) {
    const std::int32_t a = mesh_.from(side), b = mesh_.to(side);
    const Side diagonal = mesh_.flip(side);
    const Side other = mesh_.behind(diagonal);
    --triangles_[a];
    --triangles_[b];
    ++triangles_[mesh_.from(diagonal)];
    ++triangles_[mesh_.to(diagonal)];
    for (const Side s : {diagonal, diagonal.next(), diagonal.previous(), other.previous()})
        leaving_[mesh_.from(s)] = s;
    return diagonal;
}

void Valences::collapse(std::int32_t v) {
    if (triangles_[v] > 5) return;
    sides_.clear();
    around(v, [&](Side side) { sides_.push_back(side); });
    Side best = Side::outside();
    int best_gain = 0;
    for (const Side side : sides_) {
        const std::int32_t u = mesh_.to(side), c = mesh_.apex(side),
                           d = mesh_.apex(mesh_.behind(side));
        const int gain = strain(v, 0) + strain(u, 0) + strain(c, 0) + strain(d, 0) -
                         strain(u, triangles_[v] - 4) - strain(c, -1) - strain(d, -1);
        if (gain <= best_gain) continue;
        if ((!is_fixed_[c] && triangles_[c] <= 4) || (!is_fixed_[d] && triangles_[d] <= 4)) {
            continue;
        }
        if (!can_collapse_to(u)) continue;
        best = side;
        best_gain = gain;
    }
    if (!best.is_outside()) collapse(best);
}

/// Whether no triangle turns over or gets too long or thin if the vertex that `sides_` leave goes
/// to where u is.
bool Valences::can_collapse_to(std::int32_t u) const {
    const PlanPoint& to = mesh_.points[u];
    const double longest = longest_after_collapse * size_.at(to);
    for (const Side side : sides_) {
        const std::int32_t a = mesh_.to(side), b = mesh_.apex(side);
        if (a == u || b == u) continue;
        const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b];
        if (side_of_line(p, q, to) <= 0) return false;
        if (mean_ratio(p, q, to) < least_ratio) return false;
        if (squared_distance(p, to) > longest * longest) return false;
    }
    return true;
}

void Valences::collapse(Side side) {
    const std::int32_t v = mesh_.from(side), u = mesh_.to(side), c = mesh_.apex(side),
                       d = mesh_.apex(mesh_.behind(side));
    triangles_[u] += triangles_[v] - 4;
    --triangles_[c];
    --triangles_[d];
    triangles_[v] = 0;
    const auto [left, right] = mesh_.collapse(side);
    leaving_[u] = left;         // from u to c
    leaving_[c] = left.next();  // a triangle of what was the star of v
    leaving_[d] = right;        // from d to u
}

void Valences::pass_by(std::int32_t v) {
    if (triangles_[v] != 2) return;
    Side side = leaving_[v];
    if (!mesh_.is_border(side)) side = mesh_.turn_right(side);
    const std::int32_t next = mesh_.to(side), opposite = mesh_.apex(side),
                       last = mesh_.apex(mesh_.behind(side.previous()));
    if (strain(v, 0) + strain(opposite, 0) <= strain(opposite, -1)) return;
    const PlanPoint &p = mesh_.points[last], &q = mesh_.points[next], &r = mesh_.points[opposite];
    const double longest = longest_after_collapse * size_.at(mesh_.points[v]);
    if (squared_distance(p, q) > longest * longest) return;
    if (mean_ratio(p, q, r) < least_ratio || side_of_line(p, q, r) <= 0) return;
    mesh_.pass_by(side);
    triangles_[v] = 0;
    --triangles_[opposite];
    leaving_[last] = side;
    leaving_[next] = side.next();
    leaving_[opposite] = side.previous();
}

}  // namespace realmodel::meshing
