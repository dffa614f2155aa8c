// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/face_quality.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::simulation {

namespace {

/// How far from its center a face is crossed, as checkMesh measures it: 1 is the edge of the face.
/// 0 where the line alone shows that it is less than kMostSkewness.
/// @param way  from the center of an element to that of the face
/// @param line  from there to the other element; at the outside to the plane of the face, upright
/// @param share  of the length of the line that counts as the size of a smaller face
double skewness(const ElementFace& face, const Vec3& way, const Vec3& line, double share) {
    const double ratio = dot(way, face.area) / dot(line, face.area);
    const Vec3 off = minus(way, times(ratio, line));  // from where the line crosses the face
    constexpr double kClear = 0.99 * kMostSkewness;
    if (dot(off, off) <= kClear * kClear * share * share * dot(line, line)) return 0;
    const double far = length(off);
    double reach = share * length(line);
    for (const Vec3& corner : face.corners)
        reach = std::max(reach, std::abs(dot(off, minus(corner, face.center))) / far);
    return far / reach;
}

}  // namespace

double inner_skewness(const ElementFace& face, const Vec3& own, const Vec3& other) {
    return skewness(face, minus(face.center, own), minus(other, own), 0.2);
}

double outer_skewness(const ElementFace& face, const Vec3& own) {
    const Vec3 way = minus(face.center, own);
    const double share = dot(way, face.area) / dot(face.area, face.area);
    return skewness(face, way, times(share, face.area), 0.4);
}

bool is_bad(const ElementFace& face, const ElementBody& own, const ElementBody& other) {
    const Vec3 line = minus(other.center, own.center), way = minus(face.center, own.center);
    const double along = dot(line, face.area), size = length(face.area);
    if (along < kMostLean * size * length(line)) return true;
    const double before = std::abs(dot(way, face.area)),
                 behind = std::abs(dot(minus(other.center, face.center), face.area));
    if (std::min(before, behind) < kLeastWeight * (before + behind)) return true;
    if (std::min(own.volume, other.volume) < kLeastShare * std::max(own.volume, other.volume))
        return true;
    return inner_skewness(face, own.center, other.center) > kMostSkewness;
}

ElementFace side_face(const Vec2& a, const Vec2& b, const std::array<double, 2>& low,
                      const std::array<double, 2>& high) {
    const double at_a = high[0] - low[0], at_b = high[1] - low[1], sum = at_a + at_b;
    ElementFace face{{{{a[0], a[1], low[0]},
                       {b[0], b[1], low[1]},
                       {b[0], b[1], high[1]},
                       {a[0], a[1], high[0]}}},
                     {(b[1] - a[1]) * sum / 2, -(b[0] - a[0]) * sum / 2, 0},
                     {}};
    // of the two triangles at the diagonal from the first corner, the first is as large as at_b
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& c = face.corners;
        face.center[k] =
            (at_b * (c[0][k] + c[1][k] + c[2][k]) + at_a * (c[0][k] + c[2][k] + c[3][k])) /
            (3 * sum);
    }
    return face;
}

double determinant_of(std::span<const Vec3> areas) {
    double mean = 0;
    for (const Vec3& area : areas)
        mean += length(area);
    if (!(mean > 0)) return 0;
    mean /= static_cast<double>(areas.size());
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (const Vec3& area : areas) {
        const double x = area[0] / mean, y = area[1] / mean, z = area[2] / mean;
        xx += x * x;
        xy += x * y;
        xz += x * z;
        yy += y * y;
        yz += y * z;
        zz += z * z;
    }
    return std::abs(xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) +
                    xz * (xy * yz - yy * xz)) /
           8;
}

}  // namespace realmodel::simulation
