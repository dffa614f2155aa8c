// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "base/counting_sort.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// Finds the triangle of a planar mesh that a position lies in: triangles are kept by the tiles
/// that their boxes meet. Exact; a position on several triangles gets the one with the least
/// number.
class MeshLocator {
public:
    using Triangle = std::array<std::int32_t, 3>;

    /// A position in a triangle: weights of its corners, not negative, of sum 1.
    struct BarycentricPosition {
        std::int32_t triangle;
        std::array<double, 3> weights;
    };

    static constexpr PlanBox kEverywhere{-HUGE_VAL, -HUGE_VAL, HUGE_VAL, HUGE_VAL};

    /// The vertices and triangles must outlive this and stay as they are. Triangles may turn either
    /// way; those without area in plan hold no position.
    /// @param asked  positions outside this box need not be found
    /// @throws InputError kind "not_finite" (items: the vertex), "bad_index" (items: the triangle)
    MeshLocator(std::span<const PlanPosition> vertices, std::span<const Triangle> triangles,
                const PlanBox& asked = kEverywhere);

    std::optional<BarycentricPosition> find(const PlanPosition& position) const;

private:
    std::array<PlanPosition, 3> corners_of(const Triangle& triangle) const;

    std::span<const PlanPosition> vertices_;
    std::span<const Triangle> triangles_;
    PlanTiles tiles_;
    Buckets<std::int32_t> triangles_at_;  ///< of each tile
};

}  // namespace realmodel::spatial
