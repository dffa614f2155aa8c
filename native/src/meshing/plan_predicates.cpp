// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/plan_predicates.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "base/algorithms.hpp"
#include "exact/cgal_kernel.hpp"

namespace realmodel::meshing {

namespace {

using KernelPoint = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;

KernelPoint exact_point(const PlanPoint& p) {
    return {p[0], p[1]};
}

}  // namespace

int in_circle_exactly(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                      const PlanPoint& p) {
    return static_cast<int>(CGAL::side_of_oriented_circle(exact_point(a), exact_point(b),
                                                          exact_point(c), exact_point(p)));
}

bool cross_properly(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                    const PlanPoint& d) {
    return orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0;
}

PlanPoint crossing_place(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c,
                         const PlanPoint& d) {
    const PlanPoint u = minus(b, a), v = minus(d, c);
    const double across = cross(u, v);
    if (across == 0) return c;  // parallel up to rounding: any of the ends tells where
    return moved(a, cross(minus(c, a), v) / across, u);
}

std::vector<std::int32_t> first_equal(std::span<const PlanPoint> places) {
    std::vector<std::int32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](std::int32_t i) { return std::pair(places[i], i); });
    std::vector<std::int32_t> first(places.size());
    for (const auto equal : groups_of(order, [&](std::int32_t i) { return places[i]; })) {
        for (const std::int32_t i : equal)
            first[i] = equal[0];
    }
    return first;
}

std::string text_of(const PlanPoint& place) {
    std::array<char, 80> text{};
    std::snprintf(text.data(), text.size(), "(%.12g, %.12g)", place[0], place[1]);
    return text.data();
}

}  // namespace realmodel::meshing
