// SPDX-License-Identifier: GPL-3.0-or-later
/// What OpenFOAM's checkMesh measures of an element and its faces.
#pragma once

#include <array>
#include <span>

#include "base/vectors.hpp"

namespace realmodel::simulation {

// Its limits, or a little within them.
inline constexpr double kWeakDeterminant = 0.0011;  ///< of a cube it is 1; its limit is 0.001
inline constexpr double kMostLean = 0.36;           ///< cosine of 69 degrees; its limit is 70
inline constexpr double kSkewnessLimit = 4;         ///< without any option
inline constexpr double kMostSkewness = 3.8;        ///< what is repaired
inline constexpr double kLeastWeight = 0.052;       ///< its limit is 0.05
inline constexpr double kLeastShare = 0.0105;       ///< of a neighbor's volume; its limit is 0.01

/// A face of an element, of three or four corners (of three one is twice there).
struct ElementFace {
    std::array<Vec3, 4> corners;
    Vec3 area, center;
};
struct ElementBody {
    Vec3 center;
    double volume;
};

/// The side of a column between heights `low` and `high` at points a and b of the plan.
ElementFace side_face(const Vec2& a, const Vec2& b, const std::array<double, 2>& low,
                      const std::array<double, 2>& high);

/// How far from its center a face is crossed by the line between the centers of its elements: 1 is
/// the edge of the face. 0 where it is clearly less than kMostSkewness.
double inner_skewness(const ElementFace& face, const Vec3& own, const Vec3& other);
/// The same at the outside, where the line is upright on the face.
double outer_skewness(const ElementFace& face, const Vec3& own);
/// Whether checkMesh fails a face between two elements: for the angle of the line between their
/// centers, where this crosses the face, or their sizes.
bool is_bad(const ElementFace& face, const ElementBody& own, const ElementBody& other);

/// The determinant of the sum of n n^T over the inner faces of an element, by eight (n: the normal,
/// as long as the area over the mean area). It is 0 where these face in two directions only.
double determinant_of(std::span<const Vec3> areas);

}  // namespace realmodel::simulation
