// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "exact/homogeneous_points.hpp"
#include "exact/orientation.hpp"
#include "exact/space_points.hpp"

namespace realmodel::exact {

namespace {

using ConstructedPoint = SpacePoints::ConstructedPoint;

/// The difference of two coordinates: without error where both are doubles.
DoubleDoubleInterval difference(const DoubleDoubleInterval& to, const DoubleDoubleInterval& from) {
    const auto is_double = [](const DoubleDoubleInterval& x) { return x.low == 0 && x.error == 0; };
    if (is_double(from) && is_double(to))
        return DoubleDoubleInterval::difference(to.high, from.high);
    return to - from;
}

/// How far the differences of these points' rounded coordinates may be from the true ones.
template <std::size_t kCount>
double inexactness(const SpacePoints& points, const std::array<SpacePointId, kCount>& of) {
    double largest = -1;
    for (const SpacePointId p : of) {
        if (points.is_double(p)) continue;
        for (const double x : points.rounded(p))
            largest = std::max(largest, std::abs(x));
    }
    return largest < 0 ? 0 : inexactness_of_rounding(largest);
}

/// Whether points were constructed on one line, or are its ends.
bool lie_on_one_line_by_construction(const SpacePoints& points,
                                     const std::array<SpacePointId, 3>& of) {
    for (const SpacePointId candidate : of) {
        for (const SpacePoints::SpaceLine& line : points.lines(candidate)) {
            if (line[0] == kNone) break;
            const bool all = std::ranges::all_of(of, [&](SpacePointId p) {
                return p == line[0] || p == line[1] ||
                       points.was_constructed_on(p, line[0], line[1]);
            });
            if (all) return true;
        }
    }
    return false;
}

/// Whether points were constructed in one plane, or are its corners.
bool lie_on_one_plane_by_construction(const SpacePoints& points,
                                      const std::array<SpacePointId, 4>& of) {
    for (const SpacePointId candidate : of) {
        const ConstructedPoint* constructed = points.construction(candidate);
        if (constructed == nullptr) continue;
        const auto corners = std::span(constructed->of.of).subspan<2>();
        const auto is_corner = [&](SpacePointId p) {
            return std::find(corners.begin(), corners.end(), p) != corners.end();
        };
        const bool all = std::all_of(of.begin(), of.end(), [&](SpacePointId p) {
            const ConstructedPoint* other = points.construction(p);
            if (other == nullptr) return is_corner(p);
            return other->of.is_on_plane_of(constructed->of) ||
                   (is_corner(other->of.of[0]) && is_corner(other->of.of[1]));
        });
        if (all) return true;
    }
    for (std::size_t without = 0; without < 4; ++without) {
        if (lie_on_one_line_by_construction(
                points, {of[(without + 1) % 4], of[(without + 2) % 4], of[(without + 3) % 4]}))
            return true;
    }
    return false;
}

/// A coordinate to twice the precision of doubles.
DoubleDoubleInterval interval(const SpacePoints& points, SpacePointId p, std::size_t axis) {
    if (const ConstructedPoint* point = points.construction(p)) return point->at[axis];
    if (const SpacePoints::Fractions* point = points.fractions(p)) return point->interval[axis];
    return points.rounded(p)[axis];
}

std::optional<int> orient3d_by_intervals(const SpacePoints& points,
                                         const std::array<SpacePointId, 4>& of) {
    std::array<std::array<DoubleDoubleInterval, 3>, 3> from_first;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto first = interval(points, of[0], k);
        for (std::size_t i = 0; i < 3; ++i)
            from_first[i][k] = difference(interval(points, of[i + 1], k), first);
    }
    const auto& [u, v, w] = from_first;
    return dot(w, cross(u, v)).sign();
}

std::optional<int> orient2d_by_intervals(const SpacePoints& points, std::size_t axis,
                                         const std::array<SpacePointId, 3>& of) {
    std::array<std::array<DoubleDoubleInterval, 2>, 2> from_first;
    for (std::size_t k = 0; k < 2; ++k) {
        const auto first = interval(points, of[0], (axis + 1 + k) % 3);
        for (std::size_t i = 0; i < 2; ++i)
            from_first[i][k] = difference(interval(points, of[i + 1], (axis + 1 + k) % 3), first);
    }
    const auto& [u, v] = from_first;
    return (u[0] * v[1] - u[1] * v[0]).sign();
}

template <class Integer>
std::optional<int> orient3d_in(const HomogeneousPoints<Integer>& in,
                               const std::array<SpacePointId, 4>& of) {
    using IntegerPoints = HomogeneousPoints<Integer>;
    std::array at{in.point(of[0]), in.point(of[1]), in.point(of[2]), in.point(of[3])};
    // each exchange of two points reverses the sign
    const std::size_t origin = IntegerPoints::simplest(at);
    int sign = 1;
    if (origin != 0) {
        std::swap(at[0], at[origin]);
        sign = -1;
    }
    std::array<std::array<Integer, 3>, 3> from_first;
    for (std::size_t i = 0; i < 3; ++i) {
        from_first[i] = IntegerPoints::minus(at[i + 1], at[0]);
        sign *= sign_of(at[i + 1].weight) * sign_of(at[0].weight);
    }
    const auto& [u, v, w] = from_first;
    const Integer det = dot(w, cross(u, v));
    if (!is_known(det)) return std::nullopt;
    return sign * sign_of(det);
}

template <class Integer>
std::optional<int> orient2d_in(const HomogeneousPoints<Integer>& in, std::size_t axis,
                               const std::array<SpacePointId, 3>& of) {
    using IntegerPoints = HomogeneousPoints<Integer>;
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    std::array at{in.point(of[0]), in.point(of[1]), in.point(of[2])};
    const auto origin = static_cast<std::ptrdiff_t>(IntegerPoints::simplest(at));
    std::rotate(at.begin(), at.begin() + origin, at.end());
    const auto u = IntegerPoints::minus(at[1], at[0]), v = IntegerPoints::minus(at[2], at[0]);
    const Integer det = u[k] * v[l] - u[l] * v[k];
    if (!is_known(det)) return std::nullopt;
    return sign_of(det) * sign_of(at[1].weight) * sign_of(at[2].weight);
}

/// The lexicographic order of coordinates from axis `first` on, before `end`.
template <class Integer>
std::optional<int> compare_in(const HomogeneousPoints<Integer>& in, std::size_t first,
                              std::size_t end, SpacePointId a, SpacePointId b) {
    const auto p = in.point(a), q = in.point(b);
    for (std::size_t axis = first; axis < end; ++axis) {
        const Integer offset = in.times(p.at[axis], q) - in.times(q.at[axis], p);
        if (!is_known(offset)) return std::nullopt;
        if (const int sign = sign_of(offset)) return sign * sign_of(p.weight) * sign_of(q.weight);
    }
    return 0;
}

int compare(const SpacePoints& points, std::size_t first, std::size_t end, SpacePointId a,
            SpacePointId b) {
    if (a == b) return 0;
    for (std::size_t axis = first; axis < end; ++axis) {
        const double x = points.rounded(a)[axis], y = points.rounded(b)[axis];
        if (x != y) return x < y ? -1 : 1;  // rounding keeps the order
        if (points.is_double(a) && points.is_double(b)) continue;
        const auto apart = difference(interval(points, a, axis), interval(points, b, axis));
        const auto sign = apart.sign();
        if (sign == 0) continue;
        if (sign) return *sign;
        return by_integers(points, std::array{a, b},
                           [&](auto&& in) { return compare_in(in, axis, end, a, b); });
    }
    return 0;
}

}  // namespace

int orient3d(const SpacePoints& points, SpacePointId a, SpacePointId b, SpacePointId c,
             SpacePointId d) {
    if (a == b || a == c || a == d || b == c || b == d || c == d) return 0;
    const std::array of{a, b, c, d};
    if (const auto sign = orient3d_filter(points.rounded(a), points.rounded(b), points.rounded(c),
                                          points.rounded(d), inexactness(points, of)))
        return *sign;
    if (lie_on_one_plane_by_construction(points, of)) return 0;
    if (const auto sign = orient3d_by_intervals(points, of)) return *sign;
    return by_integers(points, of, [&](auto&& in) { return orient3d_in(in, of); });
}

SidesOfPlane::SidesOfPlane(const SpacePoints& points, const std::array<SpacePointId, 3>& corners)
    : points_(points),
      corners_(corners),
      filter_(points.rounded(corners[0]), points.rounded(corners[1]), points.rounded(corners[2])) {}

int SidesOfPlane::operator()(SpacePointId d) const {
    const auto [a, b, c] = corners_;
    if (d == a || d == b || d == c) return 0;
    const auto sign = filter_(points_.rounded(d), inexactness(points_, std::array{a, b, c, d}));
    return sign ? *sign : orient3d(points_, a, b, c, d);
}

int orient2d(const SpacePoints& points, std::size_t axis, SpacePointId a, SpacePointId b,
             SpacePointId c) {
    assert(axis < 3);
    if (a == b || a == c || b == c) return 0;
    const auto seen = [&](SpacePointId p) {
        return std::array{points.rounded(p)[(axis + 1) % 3], points.rounded(p)[(axis + 2) % 3]};
    };
    const std::array of{a, b, c};
    if (const auto sign = orient2d_filter(seen(a), seen(b), seen(c), inexactness(points, of)))
        return *sign;
    if (lie_on_one_line_by_construction(points, of)) return 0;
    if (const auto sign = orient2d_by_intervals(points, axis, of)) return *sign;
    return by_integers(points, of, [&](auto&& in) { return orient2d_in(in, axis, of); });
}

int compare(const SpacePoints& points, std::size_t axis, SpacePointId a, SpacePointId b) {
    assert(axis < 3);
    return compare(points, axis, axis + 1, a, b);
}

int compare(const SpacePoints& points, SpacePointId a, SpacePointId b) {
    return compare(points, 0, 3, a, b);
}

int ray_crosses(const SpacePoints& points, std::size_t axis, SpacePointId p,
                const std::array<SpacePointId, 3>& corners, bool from_below) {
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    for (const std::size_t across : {k, l}) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const SpacePointId c : corners) {
            low = std::min(low, points.rounded(c)[across]);
            high = std::max(high, points.rounded(c)[across]);
        }
        if (points.rounded(p)[across] < low || points.rounded(p)[across] > high) return 0;
    }
    const int facing = orient2d(points, axis, corners[0], corners[1], corners[2]);
    if (facing == 0) return 0;
    // edges to the right of p, which is taken to be a little to the right and less upward from here
    bool inside = false;
    for (std::size_t i = 0; i < 3; ++i) {
        SpacePointId a = corners[i], b = corners[(i + 1) % 3];
        const bool above_a = compare(points, l, a, p) > 0, above_b = compare(points, l, b, p) > 0;
        if (above_a == above_b) continue;
        if (above_a) std::swap(a, b);
        if (orient2d(points, axis, a, b, p) > 0) inside = !inside;
    }
    if (!inside) return 0;
    const int side = facing * orient3d(points, corners[0], corners[1], corners[2], p);
    return side < 0 || (side == 0 && from_below) ? facing : 0;
}

bool is_farther(const SpacePoints& points, std::size_t axis, SpacePointId a, SpacePointId b,
                SpacePointId p, SpacePointId q) {
    const RationalPoint o = points.exact(a), line = minus(points.exact(b), o);
    return abs(cross(line, minus(points.exact(p), o), axis)) >
           abs(cross(line, minus(points.exact(q), o), axis));
}

}  // namespace realmodel::exact
