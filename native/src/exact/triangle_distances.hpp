// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

namespace realmodel::exact {

/// A triangle in doubles, and which of its edges count: bit i for the one after corner i.
struct MarkedTriangle {
    std::array<std::array<double, 3>, 3> corners;
    unsigned edges = 0;
};

/// Bounds of the distance of a triangle, or of a segment (a, b, b), from a point.
struct DistanceBounds {
    double low, high;
};
DistanceBounds distance_bounds(const std::array<double, 3>& p,
                               const std::array<std::array<double, 3>, 3>& triangle);

/// Of some triangles those that are nearest to a point, exactly, in order.
struct NearestTriangles {
    std::vector<std::size_t> numbers;
    bool are_on_edge;  ///< whether the nearest point of one of them is on an edge that counts
};
NearestTriangles nearest_triangles(const std::array<double, 3>& p,
                                   std::span<const MarkedTriangle> triangles);

/// The first of those triangles, which have areas, whose planes are farthest from a point, exactly.
std::size_t farthest_plane(const std::array<double, 3>& p,
                           std::span<const MarkedTriangle> triangles);

/// Which of two triangles' planes a line from one point to another passes first: -1 the first, 1
/// the other, 0 both in one point. Each plane has the ends on both sides, or one of them on it.
/// Exact.
int compare_crossings(const std::array<double, 3>& from, const std::array<double, 3>& to,
                      const std::array<std::array<double, 3>, 3>& first,
                      const std::array<std::array<double, 3>, 3>& other);

}  // namespace realmodel::exact
