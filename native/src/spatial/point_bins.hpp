// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "base/counting_sort.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// Points in plan, in tiles about as many as there are points: finds the few within a box.
class PointBins {
public:
    using Position = PlanPosition;

    explicit PointBins(const std::vector<Position>& points)
        : tiles_(box_around(points), points.size()) {
        bins_ = bucketize<Item>(tiles_.size(), [&](const auto& put) {
            for (std::size_t i = 0; i < points.size(); ++i)
                put(tiles_.tile_at(points[i]), Item{points[i], i});
        });
    }

    /// Calls visit(number, position) for every point within the box, borders included.
    template <class Visit>
    void within(const PlanBox& box, const Visit& visit) const {
        if (!box.meets(tiles_.frame())) return;
        tiles_.for_each(tiles_.span(box), [&](std::size_t tile) {
            for (const auto& [p, number] : bins_[tile]) {
                if (box.contains(p)) visit(number, p);
            }
        });
    }

private:
    struct Item {
        Position position;
        std::size_t number;
    };

    PlanTiles tiles_;
    Buckets<Item> bins_;
};

}  // namespace realmodel::spatial
