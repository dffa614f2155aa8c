// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
#include "realmodel/simulation/filled_mesh.hpp"

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

}  // namespace realmodel::simulation
