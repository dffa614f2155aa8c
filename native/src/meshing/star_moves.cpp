// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/star_moves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"

namespace realmodel::meshing {

namespace {

// Steps are made longer than Newton's: each vertex moves alone, and its neighbors will follow
// (successive over-relaxation, Young 1954).
constexpr double kFreeStep = 1.5, kSlidingStep = 1.4;
constexpr double kMovedEnough = 1e-3;  // of an edge: less is not worth another visit

}  // namespace

/// 4 sqrt(3) / mean ratio of a triangle over base a-b, as a function of its apex, with derivatives:
/// convex for apexes left of the base.
struct StarMoves::Shape {
    double value = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    /// False where the apex is not left of the base.
    bool add(const PlanPoint& a, const PlanPoint& b, const PlanPoint& apex) {
        const double bx = b[0] - a[0], by = b[1] - a[1];
        const double base = std::sqrt(bx * bx + by * by);
        const double ux = bx / base, uy = by / base;
        const double px = apex[0] - 0.5 * (a[0] + b[0]), py = apex[1] - 0.5 * (a[1] + b[1]);
        const double s = px * ux + py * uy, h = py * ux - px * uy;
        if (!(h > 0)) return false;
        const double over = 1 / (base * h);
        const double ds = 8 * s * over, dh = (4 * h * h - 3 * base * base - 4 * s * s) * over / h;
        const double dss = 8 * over, dsh = -ds / h,
                     dhh = (8 * s * s + 6 * base * base) * over / (h * h);
        value += (3 * base * base + 4 * s * s + 4 * h * h) * over;
        x += ds * ux - dh * uy;
        y += ds * uy + dh * ux;
        xx += dss * ux * ux - 2 * dsh * ux * uy + dhh * uy * uy;
        xy += dss * ux * uy + dsh * (ux * ux - uy * uy) - dhh * ux * uy;
        yy += dss * uy * uy + 2 * dsh * ux * uy + dhh * ux * ux;
        return true;
    }
};

std::int32_t StarMoves::add_line(const PlanPoint& begin, const PlanPoint& end) {
    lines_.push_back({begin, end});
    return static_cast<std::int32_t>(lines_.size()) - 1;
}

void StarMoves::move(std::int32_t v) {
    if (slides(v)) {
        slide(v);
    } else if (moves_freely(v)) {
        go_freely(v);
    }
}

/// Goes as large a share of a way as makes the star better.
template <class Place>
void StarMoves::step(std::int32_t v, const Shape& now, double way, const Place& place_at) {
    PlanPoint& p = mesh_.points[v];
    if (!std::isfinite(now.value) || !std::isfinite(way)) return;
    const double least = kMovedEnough * std::sqrt(squared_distance(p, mesh_.points[base_[0][0]]));
    double share = slides(v) ? kSlidingStep : kFreeStep;
    for (int halving = 0; halving < 6; ++halving, share /= 2) {
        if (share * way < least) return;
        const PlanPoint place = place_at(share);
        if (!(shape_at(place).value < now.value)) continue;
        const bool is_upright = std::all_of(base_.begin(), base_.end(), [&](const auto& base) {
            return orient2d(mesh_.points[base[0]], mesh_.points[base[1]], place) > 0;
        });
        if (!is_upright) continue;
        p = place;
        return;
    }
}

void StarMoves::go_freely(std::int32_t v) {
    const PlanPoint& p = mesh_.points[v];
    const Shape now = shape_of_star(v);
    const double determinant = now.xx * now.yy - now.xy * now.xy;
    const double dx = -(now.yy * now.x - now.xy * now.y) / determinant;
    const double dy = -(now.xx * now.y - now.xy * now.x) / determinant;
    step(v, now, std::sqrt(dx * dx + dy * dy), [&](double share) {
        return PlanPoint{p[0] + share * dx, p[1] + share * dy};
    });
}

/// The same along the line between two corners of the border.
void StarMoves::slide(std::int32_t v) {
    const PlanPoint& p = mesh_.points[v];
    const auto& line = lines_[kinds_[v]];
    const PlanPoint &a = line[0], &b = line[1];
    const double length = std::sqrt(squared_distance(a, b));
    const double ux = (b[0] - a[0]) / length, uy = (b[1] - a[1]) / length;
    const Shape now = shape_of_star(v);
    const double bend = ux * ux * now.xx + 2 * ux * uy * now.xy + uy * uy * now.yy;
    const double along = -(ux * now.x + uy * now.y) / bend;
    const double from = (p[0] - a[0]) * ux + (p[1] - a[1]) * uy;
    step(v, now, std::abs(along), [&](double share) {
        const double where = (from + share * along) / length;  // from the corners, rounded once
        return moved(a, where, minus(b, a));
    });
}

StarMoves::Shape StarMoves::shape_of_star(std::int32_t v) {
    base_.clear();
    valences_.around(v, [&](HalfEdge edge) {
        base_.push_back({mesh_.to(edge), mesh_.apex(edge)});
    });
    return shape_at(mesh_.points[v]);
}

/// Of the star that base_ bounds; its value is infinite where a triangle would be turned over.
StarMoves::Shape StarMoves::shape_at(const PlanPoint& place) const {
    Shape shape;
    for (const auto& [a, b] : base_) {
        if (shape.add(mesh_.points[a], mesh_.points[b], place)) continue;
        shape.value = std::numeric_limits<double>::infinity();
        break;
    }
    return shape;
}

}  // namespace realmodel::meshing
