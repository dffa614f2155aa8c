// SPDX-License-Identifier: GPL-3.0-or-later
// Repairs of tetrahedra that solvers compute badly on: those in corners, and flat ones.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/vectors.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/simulation/filled_mesh.hpp"
#include "simulation/boundary_faces.hpp"

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

/// The elements beside a face, the second -1 if it is outside.
/// @param at_corner  the elements at one of its corners
std::array<std::int32_t, 2> elements_beside(std::span<const std::array<std::int32_t, 4>> elements,
                                            std::span<const std::int32_t> at_corner,
                                            const std::array<std::int32_t, 3>& face);

/// One round of changes of a mesh: none touches what another one has changed.
class TetrahedraRound {
public:
    explicit TetrahedraRound(FilledMesh& mesh);

    /// Divides tetrahedra with two or three faces outside, with their neighbors.
    /// @return whether any was
    bool divide_corners(Progress* progress);

    /// Fills a dent of the outside: a new point above a corner or an edge of the outside, and
    /// tetrahedra between it and the faces outside that meet there, each of the region of its face.
    /// Boundaries that end there go on to the new point.
    /// @return whether it was done: none may be turned or flat
    bool cover(std::span<const std::int32_t> corners, const Vec3& at);

private:
    std::array<std::int32_t, 2> beside(const std::array<std::int32_t, 3>& face) const;
    /// A new point in the middle of an edge or a face; everything that has it is divided.
    bool divide(std::span<const std::int32_t> between);

    FilledMesh& mesh_;
    // as they were before the round
    const Buckets<std::int32_t> tetrahedra_at_, triangles_at_;
    const std::vector<std::array<std::int32_t, 4>> tetrahedra_;
    const std::vector<std::array<std::int32_t, 3>> triangles_;
    std::vector<std::uint8_t> is_taken_;
};

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

/// Gives each outside face of the mesh the surface of the exact outside face that it comes from.
/// Corners that are off it (where a sharp edge is cut short, or flat elements were left out) move
/// onto it where the elements around stay positive, or are covered by new elements, so that walls
/// and flat bases stay in their planes.
/// @param reach  how far corners may lie from the face that they come from, and move
/// @throws Cancelled
void sort_outside_faces(FilledMesh& mesh, const ComplexView& model,
                        std::span<const BoundaryTriangle> triangles, double reach,
                        Progress* progress);

}  // namespace realmodel::simulation
