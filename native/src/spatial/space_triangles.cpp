// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/space_triangles.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/vectors.hpp"

namespace realmodel::spatial {

double triangle_distance(const Vec3& p, const SpaceTriangle& triangle) {
    SpaceTriangle edges, apart;
    std::size_t longest = 0, nearest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        edges[i] = minus(triangle[(i + 1) % 3], triangle[i]);
        apart[i] = minus(p, triangle[i]);
        if (dot(edges[i], edges[i]) > dot(edges[longest], edges[longest])) longest = i;
        if (dot(apart[i], apart[i]) < dot(apart[nearest], apart[nearest])) nearest = i;
    }
    Vec3 normal = cross(edges[(longest + 1) % 3], edges[(longest + 2) % 3]);
    const double size = length(normal);
    for (double& each : normal)
        each /= size;
    bool inside = true;
    double to_border = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
        inside &= dot(cross(edges[i], apart[i]), normal) >= 0;
        const double square = dot(edges[i], edges[i]);
        const double share =
            square > 0 ? std::clamp(dot(apart[i], edges[i]) / square, 0.0, 1.0) : 0.0;
        const Vec3 off = minus(p, moved(triangle[i], share, edges[i]));
        to_border = std::min(to_border, length(off));
    }
    return inside ? std::abs(dot(apart[nearest], normal)) : to_border;
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
