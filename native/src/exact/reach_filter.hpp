// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "exact/local_arrangement.hpp"

namespace realmodel::exact {

/// A directed line as a (x - x0) + b (y - y0) + c, with one bound for its error at all points
/// within reach of the input vertices. Most signs are certain far beyond it, and it costs nothing
/// for each point.
struct ReachFilter {
    double a, b, c, x0, y0, bound;
};

/// That of any line: the bound is LineFilter::error_at at the farthest point.
ReachFilter reach_filter(const LocalArrangement& scope, DirectedLine line);

/// That of the line through two input vertices, whatever it is made of.
inline ReachFilter reach_filter_between(const PlanReach& reach, const Point& from,
                                        const Point& to) {
    const double a = from.y - to.y, b = to.x - from.x;
    return {a,      b,
            0,      from.x,
            from.y, std::abs(a) * reach.edge_x + std::abs(b) * reach.edge_y + 2 * kTermUnderflow};
}

inline ReachFilter reach_filter(const LocalArrangement& scope, const DirectedEdge& edge) {
    const PlanArrangement& shared = scope.shared();
    if (scope.is_vertex(edge.from) && scope.is_vertex(edge.to))
        return reach_filter_between(shared.reach(), shared.point(edge.from), shared.point(edge.to));
    return reach_filter(scope, edge.line);
}

/// The position of a point for `side_of`, which is no number beyond the reach of the vertices.
inline std::array<double, 2> position_in_reach(const LocalArrangement& scope, PointId id) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const Point& p = scope.point(id);
    return scope.shared().reach().has(p.x, p.y) ? std::array{p.x, p.y} : std::array{kNone, kNone};
}

/// The same as LocalArrangement::side, with the line's filter and the point's position_in_reach.
/// This is the question asked most of all, so it is inlined.
[[gnu::always_inline]] inline int side_of(LocalArrangement& scope, const ReachFilter& f,
                                          DirectedLine line, PointId id,
                                          const std::array<double, 2>& p) {
    const double value = f.a * (p[0] - f.x0) + f.b * (p[1] - f.y0) + f.c;
    if (!(std::abs(value) > f.bound)) return scope.side(line, id);
    scope.count_decisions(1);
    return value > 0 ? 1 : -1;
}

}  // namespace realmodel::exact
