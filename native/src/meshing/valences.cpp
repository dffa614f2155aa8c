// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/valences.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::meshing {

namespace {

constexpr double kLeastRatio = 0.35;            // of triangles that flips and collapses make
constexpr double kLongestAfterCollapse = 1.55;  // lengths wanted

}  // namespace

double mean_ratio(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    const double squares = squared_distance(a, b) + squared_distance(b, c) + squared_distance(c, a);
    return 2 * std::numbers::sqrt3 * twice_area(a, b, c) / squares;
}

Valences::Valences(FlatMesh& mesh, SizeField& size) : mesh_(mesh), size_(size) {
    const std::size_t points = mesh.points.size();
    leaving_.resize(points);
    triangles_.assign(points, 0);
    wanted_.assign(points, 6);
    is_fixed_.assign(points, false);
    mesh_.for_each_edge([&](HalfEdge edge) {
        const std::int32_t v = mesh_.from(edge);
        leaving_[v] = edge;
        ++triangles_[v];
        if (mesh_.is_fixed(edge)) is_fixed_[v] = is_fixed_[mesh_.to(edge)] = true;
    });
    want_on_lines();
}

/// Each sector between two fixed edges wants triangles of 60 degrees.
void Valences::want_on_lines() {
    std::vector<bool> seen(mesh_.points.size(), false);
    mesh_.for_each_edge([&](HalfEdge begin) {
        if (!mesh_.is_fixed(begin)) return;
        const std::int32_t v = mesh_.from(begin);
        if (!seen[v]) {
            seen[v] = true;
            wanted_[v] = 0;
        }
        double angle = angle_at(begin);
        for (HalfEdge edge = begin; !mesh_.is_fixed(edge.prev());) {
            edge = mesh_.rotate_ccw(edge);
            angle += angle_at(edge);
        }
        wanted_[v] += std::max(1, static_cast<int>(std::lround(angle * 3 / std::numbers::pi)));
    });
}

double Valences::angle_at(HalfEdge edge) const {
    const PlanPoint &p = mesh_.origin_point(edge), &a = mesh_.target_point(edge),
                    &b = mesh_.apex_point(edge);
    const double ux = a[0] - p[0], uy = a[1] - p[1], vx = b[0] - p[0], vy = b[1] - p[1];
    return elementary::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
}

int Valences::gain_of_flip(HalfEdge edge) const {
    const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge), c = mesh_.apex(edge),
                       d = mesh_.apex(mesh_.twin(edge));
    return strain(a, 0) + strain(b, 0) + strain(c, 0) + strain(d, 0) - strain(a, -1) -
           strain(b, -1) - strain(c, 1) - strain(d, 1);
}

bool Valences::can_flip(HalfEdge edge) const {
    const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge), c = mesh_.apex(edge),
                       d = mesh_.apex(mesh_.twin(edge));
    if ((triangles_[a] <= 3 && !is_fixed_[a]) || (triangles_[b] <= 3 && !is_fixed_[b])) {
        return false;
    }
    const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b], &l = mesh_.points[c],
                    &r = mesh_.points[d];
    return mean_ratio(r, l, p) >= kLeastRatio && mean_ratio(l, r, q) >= kLeastRatio &&
           orient2d(r, l, p) > 0 && orient2d(l, r, q) > 0;
}

HalfEdge Valences::flip(HalfEdge edge) {
    const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge);
    const HalfEdge diagonal = mesh_.flip(edge);
    const HalfEdge other = mesh_.twin(diagonal);
    --triangles_[a];
    --triangles_[b];
    ++triangles_[mesh_.from(diagonal)];
    ++triangles_[mesh_.to(diagonal)];
    for (const HalfEdge e : {diagonal, diagonal.next(), diagonal.prev(), other.prev()})
        leaving_[mesh_.from(e)] = e;
    return diagonal;
}

void Valences::collapse(std::int32_t v) {
    if (triangles_[v] > 5) return;
    edges_.clear();
    around(v, [&](HalfEdge edge) { edges_.push_back(edge); });
    HalfEdge best = HalfEdge::none();
    int best_gain = 0;
    for (const HalfEdge edge : edges_) {
        const std::int32_t u = mesh_.to(edge), c = mesh_.apex(edge),
                           d = mesh_.apex(mesh_.twin(edge));
        const int gain = strain(v, 0) + strain(u, 0) + strain(c, 0) + strain(d, 0) -
                         strain(u, triangles_[v] - 4) - strain(c, -1) - strain(d, -1);
        if (gain <= best_gain) continue;
        if ((!is_fixed_[c] && triangles_[c] <= 4) || (!is_fixed_[d] && triangles_[d] <= 4)) {
            continue;
        }
        if (!can_collapse_to(u)) continue;
        best = edge;
        best_gain = gain;
    }
    if (!best.is_none()) collapse(best);
}

/// Whether no triangle turns over or gets too long or thin if the vertex that `edges_` leave goes
/// to where u is.
bool Valences::can_collapse_to(std::int32_t u) const {
    const PlanPoint& to = mesh_.points[u];
    const double longest = kLongestAfterCollapse * size_.at(to);
    for (const HalfEdge edge : edges_) {
        const std::int32_t a = mesh_.to(edge), b = mesh_.apex(edge);
        if (a == u || b == u) continue;
        const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b];
        if (orient2d(p, q, to) <= 0) return false;
        if (mean_ratio(p, q, to) < kLeastRatio) return false;
        if (squared_distance(p, to) > longest * longest) return false;
    }
    return true;
}

void Valences::collapse(HalfEdge edge) {
    const std::int32_t v = mesh_.from(edge), u = mesh_.to(edge), c = mesh_.apex(edge),
                       d = mesh_.apex(mesh_.twin(edge));
    triangles_[u] += triangles_[v] - 4;
    --triangles_[c];
    --triangles_[d];
    triangles_[v] = 0;
    const auto [left, right] = mesh_.collapse(edge);
    leaving_[u] = left;         // from u to c
    leaving_[c] = left.next();  // a triangle of what was the star of v
    leaving_[d] = right;        // from d to u
}

void Valences::remove_from_border(std::int32_t v) {
    if (triangles_[v] != 2) return;
    HalfEdge edge = leaving_[v];
    if (!mesh_.is_border(edge)) edge = mesh_.rotate_cw(edge);
    const std::int32_t next = mesh_.to(edge), opposite = mesh_.apex(edge),
                       last = mesh_.apex(mesh_.twin(edge.prev()));
    if (strain(v, 0) + strain(opposite, 0) <= strain(opposite, -1)) return;
    const PlanPoint &p = mesh_.points[last], &q = mesh_.points[next], &r = mesh_.points[opposite];
    const double longest = kLongestAfterCollapse * size_.at(mesh_.points[v]);
    if (squared_distance(p, q) > longest * longest) return;
    if (mean_ratio(p, q, r) < kLeastRatio || orient2d(p, q, r) <= 0) return;
    mesh_.remove_from_border(edge);
    triangles_[v] = 0;
    --triangles_[opposite];
    leaving_[last] = edge;
    leaving_[next] = edge.next();
    leaving_[opposite] = edge.prev();
}

}  // namespace realmodel::meshing
