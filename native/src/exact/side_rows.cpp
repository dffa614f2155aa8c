// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/exact/side_rows.hpp"

#include <cmath>

#include "realmodel/exact/plan_geometry.hpp"

namespace realmodel::exact {

namespace {

/// The signs that are certain, and which are not.
struct CertainSides {
    Sides sides;
    std::uint32_t open = 0;

    [[gnu::always_inline]] inline void add(std::size_t i, double value, double bound) {
        const std::uint32_t left = value > bound ? 1U : 0U;
        const std::uint32_t right = value < -bound ? 1U : 0U;
        sides.left |= left << i;
        sides.right |= right << i;
        open |= (1U ^ (left | right)) << i;
    }
};

/// Asks what is open one by one.
template <class Ask>
Sides completed(const CertainSides& known, std::size_t size, const Ask& ask) {
    Sides sides = known.sides;
    if (known.open == 0) return sides;
    for (std::size_t i = 0; i < size; ++i) {
        if ((known.open >> i & 1U) == 0) continue;
        const int side = ask(i);
        if (side > 0) sides.left |= 1U << i;
        if (side < 0) sides.right |= 1U << i;
    }
    return sides;
}

}  // namespace

void Scope::add_to(PointRow& row, PointId id) const {
    const Point& p = point(id);
    row.within = row.within && shared_.reach().has(p.x, p.y);
    row.point[row.size] = id;
    row.x[row.size] = p.x;
    row.y[row.size] = p.y;
    ++row.size;
}

/// One bound of the error for all points within reach: that of Scope::filtered_side at the farthest
/// of them. Most signs are certain far beyond it, and it costs nothing for each point.
Scope::RowFilter Scope::row_filter(DirectedLine directed_line) const {
    const LineFilter f = filter(line_of(directed_line));
    const double sign = is_reversed(directed_line) ? -1.0 : 1.0;
    const PlanReach& reach = shared_.reach();
    return {sign * f.a, sign * f.b,
            sign * f.c, f.x0,
            f.y0,       f.error_at(reach.width, reach.height, reach.point_error) * (1 + 0x1p-40)};
}

/// The same of the line through two input vertices, whatever it is made of.
Scope::RowFilter Scope::row_filter_between(const Point& from, const Point& to) const {
    const double a = from.y - to.y, b = to.x - from.x;
    const PlanReach& reach = shared_.reach();
    return {a,      b,      0,
            from.x, from.y, std::abs(a) * reach.edge_x + std::abs(b) * reach.edge_y + 2e-290};
}

void Scope::add_to(LineRow& row, const DirectedEdge& edge) const {
    const RowFilter f = is_vertex(edge.from) && is_vertex(edge.to)
                            ? row_filter_between(point(edge.from), point(edge.to))
                            : row_filter(edge.line);
    const std::size_t i = row.size;
    row.line[i] = edge.line;
    row.a[i] = f.a;
    row.b[i] = f.b;
    row.c[i] = f.c;
    row.bound[i] = f.bound;
    row.x0[i] = f.x0;
    row.y0[i] = f.y0;
    ++row.size;
}

Sides Scope::sides(const DirectedEdge& edge, const PointRow& points) {
    if (is_vertex(edge.from) && is_vertex(edge.to))
        return sides(row_filter_between(point(edge.from), point(edge.to)), edge.line, points);
    return sides(row_filter(edge.line), edge.line, points);
}

Sides Scope::sides(const RowFilter& f, DirectedLine line, const PointRow& points) {
    const double bound = points.within ? f.bound : HUGE_VAL;
    CertainSides known;
    for (std::size_t i = 0; i < points.size; ++i)
        known.add(i, f.a * (points.x[i] - f.x0) + f.b * (points.y[i] - f.y0) + f.c, bound);
    decisions_ += points.size;
    return completed(known, points.size,
                     [&](std::size_t i) { return side(line, points.point[i]); });
}

Sides Scope::sides(const LineRow& lines, PointId id) {
    const Point& p = point(id);
    const bool within = shared_.reach().has(p.x, p.y);
    CertainSides known;
    for (std::size_t i = 0; i < lines.size; ++i) {
        known.add(i,
                  lines.a[i] * (p.x - lines.x0[i]) + lines.b[i] * (p.y - lines.y0[i]) + lines.c[i],
                  within ? lines.bound[i] : HUGE_VAL);
    }
    decisions_ += lines.size;
    return completed(known, lines.size, [&](std::size_t i) { return side(lines.line[i], id); });
}

}  // namespace realmodel::exact
