// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/side_rows.hpp"

namespace realmodel::exact {

namespace {

template <class Ask>
Sides completed(Sides known, std::size_t size, const Ask& ask) {
    std::uint32_t left = known.left(), right = known.right();
    for (std::size_t i = 0; i < size; ++i) {
        if ((known.either() >> i & 1U) != 0) continue;
        const int side = ask(i);
        if (side > 0) left |= 1U << i;
        if (side < 0) right |= 1U << i;
    }
    return {left, right};
}

}  // namespace

LineRowFilter line_row_filter(const LocalArrangement& scope, DirectedLine line) {
    const LineFilter f = scope.filter(line.id());
    const double sign = line.is_reversed() ? -1.0 : 1.0;
    const PlanReach& reach = scope.shared().reach();
    return {sign * f.a, sign * f.b, sign * f.c,
            f.x0,       f.y0,       f.error_at(reach.width, reach.height, reach.point_error)};
}

Sides complete(LocalArrangement& scope, Sides known, const PointRow& points, DirectedLine line) {
    return completed(known, points.size,
                     [&](std::size_t i) { return scope.side(line, points.point[i]); });
}

Sides complete(LocalArrangement& scope, Sides known, const LineRow& lines, PointId point) {
    return completed(known, lines.size,
                     [&](std::size_t i) { return scope.side(lines.line[i], point); });
}

}  // namespace realmodel::exact
