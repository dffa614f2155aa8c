// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "realmodel/simulation/filled_mesh.hpp"

namespace realmodel::simulation {

/// Divides tetrahedra with more than one face on the outside, with their neighbors, until each has
/// at most one: others have inner faces in two directions only, or in one, and no solver can
/// compute a gradient there. Tetrahedra without an inner face are left out.
/// @throws Cancelled
void divide_corner_tetrahedra(FilledMesh& mesh, Progress* progress);

/// Six times the volume, positive where the corners are in order.
double six_volumes(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners);

/// The tetrahedra or the triangles of a mesh that meet in each point.
template <class Rows>
Buckets<std::int32_t> rows_at(const FilledMesh& mesh, const Rows& rows) {
    return bucketize<std::int32_t>(mesh.points.size(), [&](const auto& put) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            for (const std::int32_t v : rows[i])
                put(index(v), static_cast<std::int32_t>(i));
        }
    });
}

/// Whether an element or a face has a corner.
template <std::size_t N>
bool has(const std::array<std::int32_t, N>& corners, std::int32_t v) {
    return std::find(corners.begin(), corners.end(), v) != corners.end();
}

/// It with another corner in the place of one.
template <std::size_t N>
std::array<std::int32_t, N> with(std::array<std::int32_t, N> corners, std::int32_t old,
                                 std::int32_t instead) {
    std::replace(corners.begin(), corners.end(), old, instead);
    return corners;
}

}  // namespace realmodel::simulation
