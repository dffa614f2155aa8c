// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/triangle_distances.hpp"

#include <algorithm>
#include <bit>
#include <type_traits>

#include "base/vectors.hpp"
#include "exact/arithmetic.hpp"
#include "exact/double_double_interval.hpp"
#include "exact/orientation.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {

namespace {

/// A point of a triangle that is nearest to the origin, but for rounding (C. Ericson, "Real-time
/// collision detection", 2005, section 5.1.5). It is a mean of the corners in any case.
Vec3 nearest_to_origin(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = minus(b, a), ac = minus(c, a);
    const double d1 = -dot(ab, a), d2 = -dot(ac, a);
    if (d1 <= 0 && d2 <= 0) return a;
    const double d3 = -dot(ab, b), d4 = -dot(ac, b);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return moved(a, d1 / (d1 - d3), ab);
    const double d5 = -dot(ab, c), d6 = -dot(ac, c);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return moved(a, d2 / (d2 - d6), ac);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return moved(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b));
    const double of_b = std::max(vb, 0.0), of_c = std::max(vc, 0.0);
    const double all = std::max(va, 0.0) + of_b + of_c;
    return moved(moved(a, of_b / all, ab), of_c / all, ac);
}

}  // namespace

// The nearest point of a triangle is no farther than any other one of it, and no nearer than a
// plane that has all corners beyond it. Corners relative to p are off by u of their size, what is
// summed up of them by less than 16 u: 64 u are allowed for. Sizes are such that nothing overflows,
// and what underflows otherwise is less than 2^-500.
DistanceBounds distance_bounds(const std::array<double, 3>& p,
                               const std::array<std::array<double, 3>, 3>& triangle) {
    const Vec3 a = minus(triangle[0], p), b = minus(triangle[1], p), c = minus(triangle[2], p);
    double size = 0;  // no corner is farther than this
    for (const Vec3& corner : {a, b, c})
        size = std::max({size, std::abs(corner[0]), std::abs(corner[1]), std::abs(corner[2])});
    size *= 2;
    if (!(size < 0x1p250)) return {0, HUGE_VAL};
    const double rounding = 64 * kUnitRoundoff * size + 0x1p-500;
    const auto beyond_plane = [&](const Vec3& normal, double length_of) {
        if (!(length_of > 0x1p-300)) return 0.0;
        return std::min({dot(normal, a), dot(normal, b), dot(normal, c)}) / length_of;
    };
    const Vec3 nearest = nearest_to_origin(a, b, c);
    const double high = length(nearest);
    if (!(high >= 0)) return {0, HUGE_VAL};  // products underflowed
    double low = beyond_plane(nearest, high);
    // beside a triangle its normal is known better than the way to it
    if (low < high * (1 - 0x1p-30)) {
        const Vec3 normal = cross(minus(b, a), minus(c, a));
        low =
            std::max(low, beyond_plane(times(dot(normal, a) < 0 ? -1 : 1, normal), length(normal)));
    }
    return {std::max(0.0, low - rounding), high + rounding};
}

namespace {

template <class Number>
struct Fraction {
    Number above, below;
};

/// The nearest point of a triangle, seen from the origin.
template <class Number>
struct NearestPoint {
    /// The corners of the vertex, the edge or the triangle that it lies in, one bit each.
    unsigned corners;
    Fraction<Number> square;  ///< of its distance
};

/// Triangles seen from a point in one kind of number, of which some signs may not be known.
template <class Number>
class SeenTriangles {
public:
    /// @param relative  the difference of two coordinates
    template <class Relative>
    SeenTriangles(const Vec3& p, std::span<const MarkedTriangle> triangles,
                  const Relative& relative) {
        for (const MarkedTriangle& t : triangles) {
            auto& corners = corners_.emplace_back();
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t k = 0; k < 3; ++k)
                    corners[i][k] = relative(t.corners[i][k], p[k]);
            }
        }
    }
    bool is_known() const { return is_known_; }

    int compare(const Fraction<Number>& p, const Fraction<Number>& q) {
        return sign(Number(p.above * q.below - q.above * p.below));
    }
    /// The squared distance of a plane.
    Fraction<Number> plane(std::size_t triangle) const {
        const auto& [a, b, c] = corners_[triangle];
        const auto normal = cross(minus(b, a), minus(c, a));
        const Number height = dot(normal, a);
        return {Number(height * height), dot(normal, normal)};
    }
    /// The share of the line to the first corner of another triangle at which it passes the plane.
    Fraction<Number> share(std::size_t triangle, std::size_t other) {
        const auto& [a, b, c] = corners_[triangle];
        const auto normal = cross(minus(b, a), minus(c, a));
        const Number here = dot(normal, a), whole = dot(normal, corners_[other][0]);
        if (sign(whole) > 0) return {here, whole};
        return {-here, -whole};
    }
    /// The order of questions is that of nearest_to_origin.
    NearestPoint<Number> nearest_point(std::size_t triangle) {
        const auto& [a, b, c] = corners_[triangle];
        const auto ab = minus(b, a), ac = minus(c, a);
        const Number d1 = -dot(ab, a), d2 = -dot(ac, a), d3 = -dot(ab, b), d4 = -dot(ac, b);
        if (sign(d1) <= 0 && sign(d2) <= 0) return at_corner(1, a);
        if (sign(d3) >= 0 && sign(Number(d4 - d3)) <= 0) return at_corner(2, b);
        if (sign(d1) >= 0 && sign(d3) <= 0 && sign(Number(d1 * d4 - d3 * d2)) <= 0)
            return on_edge(3, a, ab);
        const Number d5 = -dot(ab, c), d6 = -dot(ac, c);
        if (sign(d6) >= 0 && sign(Number(d5 - d6)) <= 0) return at_corner(4, c);
        if (sign(d2) >= 0 && sign(d6) <= 0 && sign(Number(d5 * d2 - d1 * d6)) <= 0)
            return on_edge(5, a, ac);
        if (sign(Number(d4 - d3)) >= 0 && sign(Number(d5 - d6)) >= 0 &&
            sign(Number(d3 * d6 - d5 * d4)) <= 0)
            return on_edge(6, b, minus(c, b));
        return {7, plane(triangle)};
    }

private:
    int sign(const Number& x) {
        if constexpr (std::is_same_v<Number, DoubleDoubleInterval>) {
            const auto known = x.sign();
            is_known_ = is_known_ && known;
            return known.value_or(0);
        } else {
            return sgn(x);
        }
    }
    static NearestPoint<Number> at_corner(unsigned bit, const std::array<Number, 3>& corner) {
        return {bit, {dot(corner, corner), Number(1)}};
    }
    static NearestPoint<Number> on_edge(unsigned bits, const std::array<Number, 3>& end,
                                        const std::array<Number, 3>& along) {
        const Number size = dot(along, along), share = dot(end, along);
        return {bits, {Number(dot(end, end) * size - share * share), size}};
    }

    std::vector<std::array<std::array<Number, 3>, 3>> corners_;
    bool is_known_ = true;
};

/// The answer ask(seen), where that is of signs that are known.
template <class Ask>
auto exactly(const Vec3& p, std::span<const MarkedTriangle> triangles, const Ask& ask) {
    SeenTriangles<DoubleDoubleInterval> in(p, triangles, &DoubleDoubleInterval::difference);
    auto answer = ask(in);
    if (in.is_known()) return answer;
    int unit = 1024;
    const auto include = [&unit](const Vec3& position) {
        for (const double x : position)
            unit = finest_exponent(x, unit);
    };
    include(p);
    for (const MarkedTriangle& t : triangles)
        std::ranges::for_each(t.corners, include);
    SeenTriangles<mpz_class> whole(
        p, triangles, [unit](double x, double y) { return whole_difference(x, y, unit); });
    return ask(whole);
}

bool has(unsigned bits, std::size_t i) {
    return (bits >> i & 1U) != 0;
}

/// Whether the given corners of two triangles are the same.
bool are_same(const MarkedTriangle& one, unsigned corners, const MarkedTriangle& other,
              unsigned others) {
    const auto is_other = [&](const Vec3& corner) {
        return std::ranges::any_of(std::array{0U, 1U, 2U}, [&](std::size_t i) {
            return has(others, i) && other.corners[i] == corner;
        });
    };
    return std::popcount(corners) == std::popcount(others) &&
           std::ranges::all_of(std::array{0U, 1U, 2U}, [&](std::size_t i) {
               return !has(corners, i) || is_other(one.corners[i]);
           });
}

bool is_on_marked_edge(unsigned corners, unsigned edges) {
    constexpr std::array<unsigned, 3> kEnds{3, 6, 5};
    return std::ranges::any_of(std::array{0U, 1U, 2U}, [&](std::size_t i) {
        return has(edges, i) && (corners & ~kEnds[i]) == 0;
    });
}

}  // namespace

NearestTriangles nearest_triangles(const std::array<double, 3>& p,
                                   std::span<const MarkedTriangle> triangles) {
    return exactly(p, triangles, [&](auto& seen) {
        NearestTriangles nearest{{0}, false};
        auto best = seen.nearest_point(0);
        nearest.are_on_edge = is_on_marked_edge(best.corners, triangles[0].edges);
        for (std::size_t i = 1; i < triangles.size(); ++i) {
            const auto point = seen.nearest_point(i);
            const bool is_same =
                are_same(triangles[i], point.corners, triangles[nearest.numbers[0]], best.corners);
            const int order = is_same ? 0 : seen.compare(point.square, best.square);
            if (order > 0) continue;
            if (order < 0) {
                nearest = {};
                best = point;
            }
            nearest.numbers.push_back(i);
            nearest.are_on_edge |= is_on_marked_edge(point.corners, triangles[i].edges);
        }
        return nearest;
    });
}

std::size_t farthest_plane(const std::array<double, 3>& p,
                           std::span<const MarkedTriangle> triangles) {
    return exactly(p, triangles, [&](auto& seen) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < triangles.size(); ++i) {
            if (seen.compare(seen.plane(i), seen.plane(best)) > 0) best = i;
        }
        return best;
    });
}

int compare_crossings(const std::array<double, 3>& from, const std::array<double, 3>& to,
                      const std::array<std::array<double, 3>, 3>& first,
                      const std::array<std::array<double, 3>, 3>& other) {
    return exactly(from, std::array<MarkedTriangle, 3>{{{first}, {other}, {{to, to, to}}}},
                   [](auto& seen) { return seen.compare(seen.share(0, 2), seen.share(1, 2)); });
}

}  // namespace realmodel::exact
