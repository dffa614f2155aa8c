// SPDX-License-Identifier: GPL-3.0-or-later
// Exact questions about points in plan.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

using exact::orient2d;

int in_circle_exactly(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                      const PlanPoint& p);

/// 1 where p lies inside the circle through a, b, c (counter-clockwise), -1 outside, 0 on it.
/// Exact; the error bound that spares most calls the exact arithmetic is that of Shewchuk 1997,
/// "Adaptive precision floating-point arithmetic and fast robust geometric predicates", section 4.
[[gnu::always_inline]] inline int in_circle(const PlanPoint& a, const PlanPoint& b,
                                            const PlanPoint& c, const PlanPoint& p) {
    const double ax = a[0] - p[0], ay = a[1] - p[1], bx = b[0] - p[0], by = b[1] - p[1],
                 cx = c[0] - p[0], cy = c[1] - p[1];
    const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by,
                 bxay = bx * ay;
    const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double det = a2 * (bxcy - cxby) + b2 * (cxay - axcy) + c2 * (axby - bxay);
    const double permanent = (std::abs(bxcy) + std::abs(cxby)) * a2 +
                             (std::abs(cxay) + std::abs(axcy)) * b2 +
                             (std::abs(axby) + std::abs(bxay)) * c2;
    const double bound =
        (10 + 96 * exact::kUnitRoundoff) * exact::kUnitRoundoff * permanent + exact::kTermUnderflow;
    if (det > bound) return 1;
    if (-det > bound) return -1;
    return in_circle_exactly(a, b, c, p);
}

/// Whether the open segments ab and cd meet in one point that ends neither of them. Exact.
bool cross_properly(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c, const PlanPoint& d);

/// Where the lines ab and cd meet, rounded; for messages.
PlanPoint crossing_place(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                         const PlanPoint& d);

inline PlanPoint middle(const PlanPoint& a, const PlanPoint& b) {
    return moved(a, 0.5, minus(b, a));
}

/// The first of the places that is equal to each.
std::vector<std::int32_t> first_equal(std::span<const PlanPoint> places);

/// "(x, y)" with as many digits as tell it from its neighbors on a map.
std::string text_of(const PlanPoint& place);

}  // namespace realmodel::meshing
