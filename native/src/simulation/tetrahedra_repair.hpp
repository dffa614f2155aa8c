// SPDX-License-Identifier: GPL-3.0-or-later
// Repairs of tetrahedra that solvers compute badly on: those in corners, and flat ones.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

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

/// The elements beside a face, the second -1 if it is outside.
/// @param at_corner  the elements at one of its corners
std::array<std::int32_t, 2> elements_beside(std::span<const std::array<std::int32_t, 4>> elements,
                                            std::span<const std::int32_t> at_corner,
                                            const std::array<std::int32_t, 3>& face);

/// Makes flat tetrahedra thicker by moving their corners: those inside regions as far as it takes,
/// those inside of one surface between regions by half of `tolerance` at most, no others. No
/// element near them becomes flatter than the flattest there was.
/// @return how many are left
/// @throws Cancelled
std::size_t thicken_flat_tetrahedra(FilledMesh& mesh, double tolerance, Progress* progress);

/// How far a tetrahedron is from flat: the determinant of the sum of n n^T over its faces, by eight
/// (n: the normal, as long as the face's area over the mean area). It is 0.3 where all edges are
/// alike; OpenFOAM's checkMesh calls cells below 0.001 under-determined.
double roundness(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners);

/// The least of some elements, at most 1; 0 where one of them has no volume.
double least_roundness(const FilledMesh& mesh, std::span<const std::int32_t> elements);

}  // namespace realmodel::simulation
