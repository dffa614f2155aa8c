// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "exact/space_points.hpp"
#include "realmodel/base/array.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::arrangement {

/// Around a ray from a point in the direction of an axis. A point and its rounded position have no
/// double between them, so the ray crosses nothing in a box that this one does not meet.
inline spatial::Box ray_box(const exact::SpacePoints& points, exact::SpacePointId from,
                            std::size_t axis) {
    spatial::Box ray;
    ray.include(points.rounded(from));
    ray.high[axis] = HUGE_VAL;
    return ray;
}

/// Finds the boxes that rays meet. A tree is made of them once it is worth its while.
class RayBoxes {
public:
    explicit RayBoxes(Array<spatial::Box> boxes) : boxes_(std::move(boxes)) {}

    /// The numbers of the boxes that a ray may meet, in order.
    /// @throws Cancelled
    std::vector<std::int32_t> find(const spatial::Box& ray, Progress* progress) {
        std::vector<std::int32_t> found;
        if (!tree_ && ++rays_ > kFewRays) {
            tree_.emplace(std::vector(boxes_.begin(), boxes_.end()), Execution{1, progress});
            boxes_ = {};
        }
        if (tree_) {
            tree_->find(ray, [&found](std::int32_t box) { found.push_back(box); });
            std::sort(found.begin(), found.end());
            return found;
        }
        for (std::size_t i = 0; i < boxes_.size(); ++i) {
            if (boxes_[i].meets(ray)) found.push_back(static_cast<std::int32_t>(i));
        }
        return found;
    }

private:
    static constexpr int kFewRays = 16;
    Array<spatial::Box> boxes_;  ///< until there is a tree
    std::optional<spatial::BoxTree> tree_;
    int rays_ = 0;
};

}  // namespace realmodel::arrangement
