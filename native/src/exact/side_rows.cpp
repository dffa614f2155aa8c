// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/exact/side_rows.hpp"

#include <cmath>

#include "realmodel/exact/plan_geometry.hpp"

namespace realmodel::exact {

namespace {

constexpr double kEpsilon = 0x1p-52;

/// The value of a line at a place, and the least that it must differ from 0 by for its sign to be
/// certain; as Scope::filtered_side.
struct Filtered {
    double value, error;
};

[[gnu::always_inline]] inline Filtered filtered(double a, double b, double c, double error_a,
                                                double error_b, double error_c, double dx,
                                                double dy, double point_error) {
    const double u = a * dx, v = b * dy;
    const double reach_x = point_error + kEpsilon * std::abs(dx);
    const double reach_y = point_error + kEpsilon * std::abs(dy);
    return {u + v + c, (std::abs(a) + error_a) * reach_x + (std::abs(b) + error_b) * reach_y +
                           error_a * std::abs(dx) + error_b * std::abs(dy) + error_c +
                           4 * kEpsilon * (std::abs(u) + std::abs(v) + std::abs(c)) + 1e-290};
}

/// The signs that are certain, and which are not.
struct CertainSides {
    Sides sides;
    std::uint32_t open = 0;

    [[gnu::always_inline]] inline void add(std::size_t i, const Filtered& at) {
        const std::uint32_t left = at.value > at.error ? 1U : 0U;
        const std::uint32_t right = at.value < -at.error ? 1U : 0U;
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
    row.point[row.size] = id;
    row.x[row.size] = p.x;
    row.y[row.size] = p.y;
    row.error[row.size] = p.error();
    ++row.size;
}

void Scope::add_to(LineRow& row, DirectedLine directed_line) const {
    const LineFilter f = filter(line_of(directed_line));
    const double sign = is_reversed(directed_line) ? -1.0 : 1.0;
    const std::size_t i = row.size;
    row.line[i] = directed_line;
    row.a[i] = sign * f.a;
    row.b[i] = sign * f.b;
    row.c[i] = sign * f.c;
    row.error_a[i] = f.error_a;
    row.error_b[i] = f.error_b;
    row.error_c[i] = f.error_c;
    row.x0[i] = f.x0;
    row.y0[i] = f.y0;
    ++row.size;
}

Sides Scope::sides(DirectedLine directed_line, const PointRow& points) {
    const LineFilter f = filter(line_of(directed_line));
    const double sign = is_reversed(directed_line) ? -1.0 : 1.0;
    const double a = sign * f.a, b = sign * f.b, c = sign * f.c;
    CertainSides known;
    for (std::size_t i = 0; i < points.size; ++i) {
        known.add(i, filtered(a, b, c, f.error_a, f.error_b, f.error_c, points.x[i] - f.x0,
                              points.y[i] - f.y0, points.error[i]));
    }
    decisions_ += points.size;
    return completed(known, points.size,
                     [&](std::size_t i) { return side(directed_line, points.point[i]); });
}

Sides Scope::sides(const LineRow& lines, PointId id) {
    const Point& p = point(id);
    const double error = p.error();
    CertainSides known;
    for (std::size_t i = 0; i < lines.size; ++i) {
        known.add(i,
                  filtered(lines.a[i], lines.b[i], lines.c[i], lines.error_a[i], lines.error_b[i],
                           lines.error_c[i], p.x - lines.x0[i], p.y - lines.y0[i], error));
    }
    decisions_ += lines.size;
    return completed(known, lines.size, [&](std::size_t i) { return side(lines.line[i], id); });
}

}  // namespace realmodel::exact
