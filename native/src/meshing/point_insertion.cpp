// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/point_insertion.hpp"

#include <algorithm>
#include <cmath>

#include "base/vectors.hpp"
#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {

namespace {

int side_of(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p) {
    return orient2d(mesh.origin_point(edge), mesh.target_point(edge), p);
}

/// In a triangle that the goal is not outside of; `on` are the edges it lies on.
Arrival arrival(const FlatMesh& mesh, std::int32_t triangle, const std::array<bool, 3>& on) {
    const auto zeros = std::count(on.begin(), on.end(), true);
    if (zeros > 1) return {Arrival::kNowhere, {}};
    if (zeros == 0) return {Arrival::kInside, {triangle, 0}};
    const HalfEdge edge(triangle,
                        static_cast<int>(std::find(on.begin(), on.end(), true) - on.begin()));
    return {mesh.is_fixed(edge) ? Arrival::kAtFixedEdge : Arrival::kOnEdge, edge};
}

}  // namespace

Arrival walk_to(const FlatMesh& mesh, std::int32_t triangle, const PlanPoint& goal) {
    HalfEdge exit = HalfEdge::none();
    std::array<bool, 3> on{};
    for (int i = 0; i < 3; ++i) {
        const HalfEdge edge(triangle, i);
        const int where = side_of(mesh, edge, goal);
        if (where < 0) exit = edge;
        on[i] = where == 0;
    }
    if (exit.is_none()) return arrival(mesh, triangle, on);

    const PlanPoint start = mesh.apex_point(exit);
    if (orient2d(start, goal, mesh.origin_point(exit)) > 0 ||
        orient2d(goal, start, mesh.target_point(exit)) > 0) {
        return {Arrival::kNowhere, {}};  // rounded to beyond two edges: too thin to judge
    }
    while (true) {
        if (mesh.is_fixed(exit)) return {Arrival::kAtFixedEdge, exit};
        const HalfEdge entry = mesh.twin(exit);
        if (entry.is_none()) return {Arrival::kNowhere, {}};
        // Seen from the start the next edge leads from the right end to the apex.
        const HalfEdge right = entry.next(), left = entry.prev();
        const int beyond_right = side_of(mesh, right, goal),
                  beyond_left = side_of(mesh, left, goal);
        if (beyond_right >= 0 && beyond_left >= 0) {
            std::array<bool, 3> flat{};
            flat[right.index()] = beyond_right == 0;
            flat[left.index()] = beyond_left == 0;
            return arrival(mesh, entry.triangle(), flat);
        }
        const int apex = orient2d(start, goal, mesh.apex_point(entry));
        if (apex == 0) {
            exit = beyond_right < 0 ? right : left;
        } else {
            exit = apex > 0 ? right : left;
        }
    }
}

std::optional<PlanPoint> circumcenter(const FlatMesh& mesh, std::int32_t triangle) {
    const auto [i, j, k] = mesh.corners[triangle];
    const PlanPoint &a = mesh.points[i], &b = mesh.points[j], &c = mesh.points[k];
    const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
    const double twice = bx * cy - by * cx;
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double x = (cy * b2 - by * c2) / (2 * twice), y = (bx * c2 - cx * b2) / (2 * twice);
    if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
    return PlanPoint{a[0] + x, a[1] + y};
}

HalfEdge Encroachment::find(const FlatMesh& mesh, const Arrival& at, const PlanPoint& p) {
    const auto sees_widely = [&](HalfEdge edge) {
        const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge);
        const double product = dot(minus(a, p), minus(b, p));
        return product < 0 &&
               product * product > 0.25 * squared_distance(a, p) * squared_distance(b, p);
    };
    cavity_.assign({at.edge.triangle()});
    if (at.kind == Arrival::kOnEdge) cavity_.push_back(mesh.twin(at.edge).triangle());
    for (std::size_t n = 0; n < cavity_.size(); ++n) {
        for (int i = 0; i < 3; ++i) {
            const HalfEdge edge(cavity_[n], i);
            if (mesh.is_fixed(edge)) {
                if (sees_widely(edge)) return edge;
                continue;
            }
            const HalfEdge other = mesh.twin(edge);
            if (std::find(cavity_.begin(), cavity_.end(), other.triangle()) != cavity_.end()) {
                continue;
            }
            if (in_circle(mesh.origin_point(other), mesh.target_point(other),
                          mesh.apex_point(other), p) > 0) {
                cavity_.push_back(other.triangle());
            }
        }
    }
    return HalfEdge::none();
}

bool can_cut(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p) {
    const auto fits = [&](HalfEdge s) {
        const PlanPoint& apex = mesh.apex_point(s);
        return orient2d(apex, mesh.origin_point(s), p) > 0 &&
               orient2d(p, mesh.target_point(s), apex) > 0;
    };
    return fits(edge) && (mesh.is_border(edge) || fits(mesh.twin(edge)));
}

}  // namespace realmodel::meshing
