// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors in plan and in space, as models store their positions. Each sum and product is rounded in
// the order in which it stands here: the bytes of models depend on it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "realmodel/base/elementary.hpp"

namespace realmodel {

using Vec2 = std::array<double, 2>;
using Vec3 = std::array<double, 3>;

constexpr Vec2 minus(const Vec2& a, const Vec2& b) {
    return {a[0] - b[0], a[1] - b[1]};
}
constexpr Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
constexpr Vec3 plus(const Vec3& a, const Vec3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
constexpr Vec3 times(double s, const Vec3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
/// a + s b
constexpr Vec2 moved(const Vec2& a, double s, const Vec2& b) {
    return {a[0] + s * b[0], a[1] + s * b[1]};
}
constexpr Vec3 moved(const Vec3& a, double s, const Vec3& b) {
    return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}

constexpr double dot(const Vec2& a, const Vec2& b) {
    return a[0] * b[0] + a[1] * b[1];
}
constexpr double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// Positive where b is to the left of a.
constexpr double cross(const Vec2& a, const Vec2& b) {
    return a[0] * b[1] - a[1] * b[0];
}
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The length of a vector whose square neither overflows nor vanishes.
inline double length(const Vec2& a) {
    return std::sqrt(dot(a, a));
}
inline double length(const Vec3& a) {
    return std::sqrt(dot(a, a));
}
/// Of length 1; 0 where the vector has no length.
inline Vec3 unit(const Vec3& a) {
    const double size = length(a);
    return size > 0 ? Vec3{a[0] / size, a[1] / size, a[2] / size} : Vec3{};
}
/// Of length 1 and perpendicular to a vector that has a length.
inline Vec3 perpendicular(const Vec3& a) {
    std::size_t least = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::abs(a[k]) < std::abs(a[least])) least = k;
    }
    Vec3 other{};
    other[least] = 1;
    return unit(cross(a, other));
}
constexpr double squared_distance(const Vec2& a, const Vec2& b) {
    return dot(minus(b, a), minus(b, a));
}
/// For all doubles, but slower than the root of the squared distance.
inline double distance(const Vec2& a, const Vec2& b) {
    return elementary::hypot(b[0] - a[0], b[1] - a[1]);
}
/// Where on the segment from a to b the point nearest to p is: from 0, at a, to 1, at b.
constexpr double nearest_share(const Vec2& a, const Vec2& b, const Vec2& p) {
    const Vec2 way = minus(b, a);
    const double square = dot(way, way);
    return square > 0 ? std::clamp(dot(minus(p, a), way) / square, 0.0, 1.0) : 0.0;
}

/// Twice the area of a triangle; positive where its corners are counter-clockwise.
constexpr double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
    return cross(minus(b, a), minus(c, a));
}
/// The normal of a triangle, twice its area long.
constexpr Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
    return cross(minus(b, a), minus(c, a));
}
/// The sum of the normals of the triangles between the first corner of a polygon and its edges,
/// twice its area long (Newell's formula; coordinates far from the origin cost no digits).
/// @param at  gives corner 0 .. corners - 1
template <class At>
constexpr Vec3 polygon_normal(std::size_t corners, const At& at) {
    Vec3 sum{}, from{};
    const Vec3 origin = at(0);
    for (std::size_t i = 1; i < corners; ++i) {
        const Vec3 to = minus(at(i), origin);
        if (i > 1) sum = plus(sum, cross(from, to));
        from = to;
    }
    return sum;
}
constexpr Vec3 polygon_normal(std::span<const Vec3> corners) {
    return polygon_normal(corners.size(), [&](std::size_t i) -> const Vec3& { return corners[i]; });
}
/// Six times the volume of a tetrahedron; positive where a, b, c are counter-clockwise seen from
/// outside.
constexpr double sixfold_volume(const Vec3& o, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u = minus(a, o), n = cross(minus(b, o), minus(c, o));
    return dot(u, n);
}

/// The middle of a triangle.
template <std::size_t N>
constexpr std::array<double, N> middle_of(const std::array<double, N>& a,
                                          const std::array<double, N>& b,
                                          const std::array<double, N>& c) {
    std::array<double, N> middle{};
    for (std::size_t k = 0; k < N; ++k) {
        for (const auto* p : {&a, &b, &c})
            middle[k] += (*p)[k] / 3;
    }
    return middle;
}

}  // namespace realmodel
