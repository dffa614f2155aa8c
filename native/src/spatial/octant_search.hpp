// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "spatial/nearest_points.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// Finds the nearest points in each eighth of the directions: looks at tiles in rings around a
/// position until no farther point can be among those wanted. One for each thread.
class OctantSearch {
public:
    struct Wanted {
        std::size_t in_octant;  ///< at most so many in each
        std::size_t in_all;     ///< at most so many of these, the nearest
        std::size_t looked_at;  ///< only the so many nearest of all points count
        double squared_radius;  ///< and only those no farther
    };

    OctantSearch(std::span<const PlanPosition> points, const Wanted& wanted);

    /// The points wanted, nearest first (of equals the lower number), but for `left_out`.
    void find(const PlanPosition& position, std::int32_t left_out, std::vector<Neighbor>& found);

private:
    void visit(std::size_t tile, const PlanPosition& position, std::int32_t left_out);
    /// Whether what lies beyond a distance can change nothing.
    bool complete(double squared_distance) const;

    std::span<const PlanPosition> points_;
    Wanted wanted_;
    PlanTiles tiles_;
    Buckets<std::int32_t> points_at_;  ///< of each tile
    std::vector<Neighbor> seen_;
    std::array<std::vector<Neighbor>, 8> taken_;
};

}  // namespace realmodel::spatial
