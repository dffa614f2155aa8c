// SPDX-License-Identifier: GPL-3.0-or-later
// The outside of tetrahedra: where it comes from, and what is still off it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/simulation/filled_mesh.hpp"
#include "simulation/boundary_faces.hpp"

namespace realmodel::simulation {

/// Fills dents of the outside. In one round nothing is covered that touches what else was.
class OutsideCovers {
public:
    explicit OutsideCovers(FilledMesh& mesh);

    /// A new point outside, above a corner or an edge of the outside: tetrahedra between it and the
    /// faces outside that meet there, each of the region of its face. Boundaries that end there go
    /// on to the new point.
    /// @return whether it was done: none may be turned or flat
    bool add(std::span<const std::int32_t> corners, const Vec3& at);

private:
    FilledMesh& mesh_;
    // as they were before the round
    const Buckets<std::int32_t> tetrahedra_at_, triangles_at_;
    const std::vector<std::array<std::int32_t, 4>> tetrahedra_;
    const std::vector<std::array<std::int32_t, 3>> triangles_;
    std::vector<std::uint8_t> is_taken_;
};

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
