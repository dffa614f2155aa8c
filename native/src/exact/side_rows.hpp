// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__) && !defined(REALMODEL_PLAIN_DOUBLE)
#include <emmintrin.h>
#endif

#include "exact/local_arrangement.hpp"

// Points or lines side by side, so that one question is asked of all of them at once: most are
// answered by floating point, two at a time; the rest one by one, exactly. These are the questions
// asked most of all, so they are inlined.
namespace realmodel::exact {

/// So many points or lines in a row at most.
inline constexpr std::size_t kRowLength = 12;

/// The bits of so many first members of a row.
inline std::uint32_t all_of_row(std::size_t size) {
    assert(size <= kRowLength);
    return (1U << size) - 1U;
}

/// Which of a row's points lie left of a line and which right of it, or of which of a row's lines a
/// point lies left or right: a bit for each; neither where the point is on the line. Both halves
/// are one word, which is written and read at once.
class Sides {
public:
    Sides() = default;
    Sides(std::uint32_t left, std::uint32_t right) : bits_(left | right << 16) {
        assert((left & right) == 0 && (left | right) <= 0xffffU);
    }

    std::uint32_t left() const { return bits_ & 0xffffU; }
    std::uint32_t right() const { return bits_ >> 16; }
    std::uint32_t either() const { return left() | right(); }
    /// Seen along the line in the other direction.
    Sides turned() const {
        Sides other;
        other.bits_ = std::rotl(bits_, 16);
        return other;
    }

private:
    std::uint32_t bits_ = 0;
};

/// Points by their numbers, with their positions.
struct PointRow {
    std::size_t size = 0;
    bool within = true;  ///< the reach of the input vertices
    std::array<PointId, kRowLength> point{};
    std::array<double, kRowLength> x{}, y{};

    void clear() {
        size = 0;
        within = true;
    }
    void add(const LocalArrangement& scope, PointId id) {
        assert(size < kRowLength);
        const Point& p = scope.point(id);
        within = within && scope.shared().reach().has(p.x, p.y);
        point[size] = id;
        x[size] = p.x;
        y[size] = p.y;
        ++size;
    }
};

/// A directed line as a (x - x0) + b (y - y0) + c, with one bound for its error at all points
/// within reach of the input vertices. Most signs are certain far beyond it, and it costs nothing
/// for each point.
struct LineRowFilter {
    double a, b, c, x0, y0, bound;
};

/// That of any line: the bound is LineFilter::error_at at the farthest point.
LineRowFilter line_row_filter(const LocalArrangement& scope, DirectedLine line);

/// That of the line through two input vertices, whatever it is made of.
inline LineRowFilter row_filter_between(const PlanReach& reach, const Point& from,
                                        const Point& to) {
    const double a = from.y - to.y, b = to.x - from.x;
    return {a,      b,
            0,      from.x,
            from.y, std::abs(a) * reach.edge_x + std::abs(b) * reach.edge_y + 2 * kTermUnderflow};
}

inline LineRowFilter line_row_filter(const LocalArrangement& scope, const DirectedEdge& edge) {
    const PlanArrangement& shared = scope.shared();
    if (scope.is_vertex(edge.from) && scope.is_vertex(edge.to))
        return row_filter_between(shared.reach(), shared.point(edge.from), shared.point(edge.to));
    return line_row_filter(scope, edge.line);
}

/// The same as LocalArrangement::side, with the line's filter; of a point that is known to be
/// within reach, as input vertices are.
[[gnu::always_inline]] inline int side_of(LocalArrangement& scope, const LineRowFilter& f,
                                          DirectedLine line, PointId id, const Point& p) {
    const double value = f.a * (p.x - f.x0) + f.b * (p.y - f.y0) + f.c;
    if (!(std::abs(value) > f.bound)) return scope.side(line, id);
    scope.count_decisions(1);
    return value > 0 ? 1 : -1;
}

/// Directed lines with their filters.
struct LineRow {
    std::size_t size = 0;
    std::array<DirectedLine, kRowLength> line{};
    std::array<double, kRowLength> a{}, b{}, c{}, x0{}, y0{}, bound{};

    void clear() { size = 0; }
    void add(const LocalArrangement& scope, const DirectedEdge& edge) {
        assert(size < kRowLength);
        const LineRowFilter f = line_row_filter(scope, edge);
        line[size] = edge.line;
        a[size] = f.a;
        b[size] = f.b;
        c[size] = f.c;
        x0[size] = f.x0;
        y0[size] = f.y0;
        bound[size] = f.bound;
        ++size;
    }
};

/// The sides that floating point tells of values with bounds of their errors, for the first `size`
/// of a row; value_of and bound_of give them two by two, as `Pair`s, from an even index on.
#if defined(__SSE2__) && !defined(REALMODEL_PLAIN_DOUBLE)
using Pair = __m128d;
inline Pair pair_of(double value) {
    return _mm_set1_pd(value);
}
inline Pair pair_at(const std::array<double, kRowLength>& row, std::size_t i) {
    return _mm_loadu_pd(row.data() + i);
}
inline std::uint32_t greater(Pair a, Pair b) {
    return static_cast<std::uint32_t>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
}
#else
struct Pair {
    double first, second;
    friend Pair operator+(Pair a, Pair b) { return {a.first + b.first, a.second + b.second}; }
    friend Pair operator-(Pair a, Pair b) { return {a.first - b.first, a.second - b.second}; }
    friend Pair operator*(Pair a, Pair b) { return {a.first * b.first, a.second * b.second}; }
    friend Pair operator-(Pair a) { return {-a.first, -a.second}; }
};
inline Pair pair_of(double value) {
    return {value, value};
}
inline Pair pair_at(const std::array<double, kRowLength>& row, std::size_t i) {
    return {row[i], row[i + 1]};
}
inline std::uint32_t greater(Pair a, Pair b) {
    return (a.first > b.first ? 1U : 0U) | (a.second > b.second ? 2U : 0U);
}
#endif
template <class ValueOf, class BoundOf>
[[gnu::always_inline]] inline Sides certain_sides(std::size_t size, const ValueOf& value_of,
                                                  const BoundOf& bound_of) {
    static_assert(kRowLength % 2 == 0 && kRowLength <= 16);
    std::uint32_t left = 0, right = 0;
    for (std::size_t i = 0; i < size; i += 2) {
        const Pair value = value_of(i), bound = bound_of(i);
        left |= greater(value, bound) << i;
        right |= greater(-bound, value) << i;
    }
    return {left & all_of_row(size), right & all_of_row(size)};
}

/// Sides of which some are not told yet: asks of these one by one, exactly.
Sides complete(LocalArrangement& scope, Sides known, const PointRow& points, DirectedLine line);
Sides complete(LocalArrangement& scope, Sides known, const LineRow& lines, PointId point);

/// The same as LocalArrangement::side of all points of a row.
inline Sides sides_of(LocalArrangement& scope, const DirectedEdge& edge, const PointRow& points) {
    const LineRowFilter f = line_row_filter(scope, edge);
    const Pair a = pair_of(f.a), b = pair_of(f.b), c = pair_of(f.c);
    const Pair x0 = pair_of(f.x0), y0 = pair_of(f.y0);
    const Pair bound = pair_of(points.within ? f.bound : HUGE_VAL);
    const Sides known = certain_sides(
        points.size,
        [&](std::size_t i) {
            return a * (pair_at(points.x, i) - x0) + b * (pair_at(points.y, i) - y0) + c;
        },
        [&](std::size_t) { return bound; });
    scope.count_decisions(points.size);
    if (known.either() == all_of_row(points.size)) return known;
    return complete(scope, known, points, edge.line);
}

/// The same as LocalArrangement::side of a point and all lines of a row.
inline Sides sides_of(LocalArrangement& scope, const LineRow& lines, PointId id) {
    const Point& p = scope.point(id);
    scope.count_decisions(lines.size);
    if (!scope.shared().reach().has(p.x, p.y)) return complete(scope, {}, lines, id);
    const Pair x = pair_of(p.x), y = pair_of(p.y);
    const Sides known = certain_sides(
        lines.size,
        [&](std::size_t i) {
            return pair_at(lines.a, i) * (x - pair_at(lines.x0, i)) +
                   pair_at(lines.b, i) * (y - pair_at(lines.y0, i)) + pair_at(lines.c, i);
        },
        [&](std::size_t i) { return pair_at(lines.bound, i); });
    if (known.either() == all_of_row(lines.size)) return known;
    return complete(scope, known, lines, id);
}

}  // namespace realmodel::exact
