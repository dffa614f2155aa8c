// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/point_insertion.hpp"

#include <algorithm>
#include <cmath>

#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {

namespace {

int side_of(const FlatMesh& mesh, Side side, const PlanPoint& p) {
    return side_of_line(mesh.point_from(side), mesh.point_to(side), p);
}

/// In a triangle that the goal is not outside of; `on` are the sides it lies on.
Arrival arrival(const FlatMesh& mesh, std::int32_t triangle, const std::array<bool, 3>& on) {
    const auto zeros = std::count(on.begin(), on.end(), true);
    if (zeros > 1) return {Arrival::nowhere, {}};
    if (zeros == 0) return {Arrival::inside, {triangle, 0}};
    const Side side(triangle, static_cast<int>(std::find(on.begin(), on.end(), true) - on.begin()));
    return {mesh.is_fixed(side) ? Arrival::at_fixed_side : Arrival::on_side, side};
}

}  // namespace

Arrival walk_to(const FlatMesh& mesh, std::int32_t triangle, const PlanPoint& goal) {
    Side exit = Side::outside();
    std::array<bool, 3> on{};
    for (int i = 0; i < 3; ++i) {
        const Side side(triangle, i);
        const int where = side_of(mesh, side, goal);
        if (where < 0) exit = side;
        on[i] = where == 0;
    }
    if (exit.is_outside()) return arrival(mesh, triangle, on);

    const PlanPoint start = mesh.point_apex(exit);
    if (side_of_line(start, goal, mesh.point_from(exit)) > 0 ||
        side_of_line(goal, start, mesh.point_to(exit)) > 0) {
        return {Arrival::nowhere, {}};  // rounded to beyond two sides: too thin to judge
    }
    while (true) {
        if (mesh.is_fixed(exit)) return {Arrival::at_fixed_side, exit};
        const Side entry = mesh.behind(exit);
        if (entry.is_outside()) return {Arrival::nowhere, {}};
        // Seen from the start the next side leads from the right end to the apex.
        const Side right = entry.next(), left = entry.previous();
        const int beyond_right = side_of(mesh, right, goal),
                  beyond_left = side_of(mesh, left, goal);
        if (beyond_right >= 0 && beyond_left >= 0) {
            std::array<bool, 3> flat{};
            flat[right.number()] = beyond_right == 0;
            flat[left.number()] = beyond_left == 0;
            return arrival(mesh, entry.triangle(), flat);
        }
        const int apex = side_of_line(start, goal, mesh.point_apex(entry));
        if (apex == 0) {
            exit = beyond_right < 0 ? right : left;
        } else {
            exit = apex > 0 ? right : left;
        }
    }
}

std::optional<PlanPoint> circumcentre(const FlatMesh& mesh, std::int32_t triangle) {
    const auto [i, j, k] = mesh.corners[triangle];
    const PlanPoint &a = mesh.points[i], &b = mesh.points[j], &c = mesh.points[k];
    const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
    const double twice = bx * cy - by * cx;
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double x = (cy * b2 - by * c2) / (2 * twice), y = (bx * c2 - cx * b2) / (2 * twice);
    if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
    return PlanPoint{a[0] + x, a[1] + y};
}

Side Encroachment::find(const FlatMesh& mesh, const Arrival& at, const PlanPoint& p) {
    const auto sees_widely = [&](Side side) {
        const PlanPoint &a = mesh.point_from(side), &b = mesh.point_to(side);
        const double dot = (a[0] - p[0]) * (b[0] - p[0]) + (a[1] - p[1]) * (b[1] - p[1]);
        return dot < 0 && dot * dot > 0.25 * squared_distance(a, p) * squared_distance(b, p);
    };
    cavity_.assign({at.side.triangle()});
    if (at.kind == Arrival::on_side) cavity_.push_back(mesh.behind(at.side).triangle());
    for (std::size_t n = 0; n < cavity_.size(); ++n) {
        for (int i = 0; i < 3; ++i) {
            const Side side(cavity_[n], i);
            if (mesh.is_fixed(side)) {
                if (sees_widely(side)) return side;
                continue;
            }
            const Side other = mesh.behind(side);
            if (std::find(cavity_.begin(), cavity_.end(), other.triangle()) != cavity_.end()) {
                continue;
            }
            if (side_of_circle(mesh.point_from(other), mesh.point_to(other), mesh.point_apex(other),
                               p) > 0) {
                cavity_.push_back(other.triangle());
            }
        }
    }
    return Side::outside();
}

bool can_cut(const FlatMesh& mesh, Side side, const PlanPoint& p) {
    const auto fits = [&](Side s) {
        const PlanPoint& apex = mesh.point_apex(s);
        return side_of_line(apex, mesh.point_from(s), p) > 0 &&
               side_of_line(p, mesh.point_to(s), apex) > 0;
    };
    return fits(side) && (mesh.is_border(side) || fits(mesh.behind(side)));
}

}  // namespace realmodel::meshing
