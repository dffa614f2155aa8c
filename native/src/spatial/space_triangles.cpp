// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/space_triangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.hpp"
#include "base/vectors.hpp"
#include "exact/double_double_interval.hpp"

namespace realmodel::spatial {

namespace {

using exact::DoubleDoubleInterval;
using Precise = std::array<DoubleDoubleInterval, 3>;

Precise precise_difference(const Vec3& a, const Vec3& b) {
    return {DoubleDoubleInterval::difference(a[0], b[0]),
            DoubleDoubleInterval::difference(a[1], b[1]),
            DoubleDoubleInterval::difference(a[2], b[2])};
}

}  // namespace

double triangle_distance(const Vec3& p, const SpaceTriangle& triangle) {
    // The normal of a narrow triangle is the difference of long products.
    const Precise u = precise_difference(triangle[1], triangle[0]);
    const Precise v = precise_difference(triangle[2], triangle[0]);
    const Precise across{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]};
    const Vec3 normal{across[0].high, across[1].high, across[2].high};
    bool inside = true;
    double to_border = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 edge = minus(triangle[(i + 1) % 3], triangle[i]), apart = minus(p, triangle[i]);
        inside &= dot(cross(edge, apart), normal) >= 0;
        const double square = dot(edge, edge);
        const double share = square > 0 ? std::clamp(dot(apart, edge) / square, 0.0, 1.0) : 0.0;
        const Vec3 off = minus(p, moved(triangle[i], share, edge));
        to_border = std::min(to_border, length(off));
    }
    const double size = length(normal);
    if (!inside || !(size > 0)) return to_border;
    const Precise apart = precise_difference(p, triangle[0]);
    const DoubleDoubleInterval volume =
        apart[0] * across[0] + apart[1] * across[1] + apart[2] * across[2];
    return std::abs(volume.high) / size;
}

std::vector<Box> boxes_of(std::span<const SpaceTriangle> triangles) {
    checked_number(triangles.size(), "triangles");
    std::vector<Box> boxes(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const Vec3& corner : triangles[t])
            boxes[t].include(corner);
    }
    return boxes;
}

}  // namespace realmodel::spatial
