// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/triangle_comparison.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

/// What triangles are to each other all over one, from the difference of two planes at its corners.
Comparison compare_at(const PlanArrangement& geometry, const exact::LineFilter& difference,
                      const PlanTriangle& triangle, double margin) {
    bool below = true, above = true;
    for (const VertexId v : triangle) {
        const exact::Point& p = geometry.point(v);
        const double dx = p.x - difference.x0, dy = p.y - difference.y0;
        const double value = difference.a * dx + difference.b * dy + difference.c;
        const double room = difference.error_at(dx, dy, 0) + margin;
        below &= value + room < 0;
        above &= value - room > 0;
    }
    if (below) return Comparison::kBelow;
    return above ? Comparison::kAbove : Comparison::kUnclear;
}

/// Whether an edge of one triangle has all of the other beyond it, for certain: they share no
/// position in plan, not even a corner.
bool is_beyond(const PlanArrangement& geometry, const PlanTriangle& triangle,
               const PlanTriangle& other) {
    for (std::size_t i = 0; i < 3; ++i) {
        const exact::LineFilter edge =
            geometry.edge_filter(triangle[i], triangle[i + 1 < 3 ? i + 1 : 0]);
        if (std::all_of(other.begin(), other.end(), [&](VertexId v) {
                const exact::Point& p = geometry.point(v);
                const double dx = p.x - edge.x0, dy = p.y - edge.y0;
                return edge.a * dx + edge.b * dy < -edge.error_at(dx, dy, 0);
            }))
            return true;
    }
    return false;
}

}  // namespace

bool are_apart(const PlanArrangement& geometry, PlaneId a, PlaneId b) {
    const PlanTriangle &p = geometry.plane(a).plan, &q = geometry.plane(b).plan;
    return is_beyond(geometry, p, q) || is_beyond(geometry, q, p);
}

Comparison compare_over(const PlanArrangement& geometry, PlaneId lower, PlaneId upper,
                        const PlanBox& a, const PlanBox& b, double margin) {
    const exact::LineFilter d = geometry.trace_filter(lower, upper);  // lower less upper
    // Beside its origin, for the middle of large coordinates is rounded by more than these differ.
    const double low_x = std::max(a.low_x, b.low_x) - d.x0;
    const double high_x = std::min(a.high_x, b.high_x) - d.x0;
    const double low_y = std::max(a.low_y, b.low_y) - d.y0;
    const double high_y = std::min(a.high_y, b.high_y) - d.y0;
    const double x = 0.5 * (low_x + high_x), y = 0.5 * (low_y + high_y);
    // boxes of parts are those of rounded corners
    const exact::PlanReach& reach = geometry.reach();
    const double half_x = 0.5 * (high_x - low_x) + reach.point_error;
    const double half_y = 0.5 * (high_y - low_y) + reach.point_error;
    const double middle = d.a * x + d.b * y + d.c;
    const double reach_x = std::abs(x) + half_x, reach_y = std::abs(y) + half_y;
    const double error =
        d.error_a * reach_x + d.error_b * reach_y + d.error_c +
        0x1p-48 * (std::abs(d.a) * reach_x + std::abs(d.b) * reach_y + std::abs(d.c));
    const double room = std::abs(d.a) * half_x + std::abs(d.b) * half_y + error + margin;
    if (middle + room < 0) return Comparison::kBelow;
    if (middle - room > 0) return Comparison::kAbove;
    const Comparison over_lower = compare_at(geometry, d, geometry.plane(lower).plan, margin);
    if (over_lower != Comparison::kUnclear) return over_lower;
    const Comparison over_upper = compare_at(geometry, d, geometry.plane(upper).plan, margin);
    if (over_upper != Comparison::kUnclear) return over_upper;
    return are_apart(geometry, lower, upper) ? Comparison::kApart : Comparison::kUnclear;
}

int side_of_border(const PlanArrangement& geometry, const PlanTriangle& triangle,
                   const std::array<double, 2>& position) {
    constexpr double kRounding = 0x1p-44;  // of coordinates, far more than a middle has
    const double error = kRounding * (std::abs(position[0]) + std::abs(position[1])) + 1e-290;
    int side = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const exact::LineFilter edge =
            geometry.edge_filter(triangle[i], triangle[i + 1 < 3 ? i + 1 : 0]);
        const double u = edge.a * (position[0] - edge.x0), v = edge.b * (position[1] - edge.y0);
        const double least =
            (std::abs(edge.a) + std::abs(edge.b)) * error + 0x1p-46 * (std::abs(u) + std::abs(v));
        if (u + v < -least) return -1;
        if (!(u + v > least)) side = 0;
    }
    return side;
}

TriangleBounds bounds_of(const PlanArrangement& geometry, PlaneId plane) {
    TriangleBounds b{spatial::kNoBox, HUGE_VAL, -HUGE_VAL};
    for (const exact::SpaceId s : geometry.plane(plane).corner) {
        const auto& vertex = geometry.space(s);
        const auto& p = geometry.point(vertex.plan);
        b.box = b.box.united({p.x, p.y, p.x, p.y});
        b.low = std::min(b.low, vertex.z);
        b.high = std::max(b.high, vertex.z);
    }
    return b;
}

std::array<double, 2> middle_of(const PlanArrangement& geometry, PlaneId plane) {
    return middle_of(geometry.plane(plane).plan,
                     [&](VertexId v) -> const exact::Point& { return geometry.point(v); });
}

}  // namespace realmodel::strata
