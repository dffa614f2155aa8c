// SPDX-License-Identifier: GPL-3.0-or-later
#include "place_heights.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace realmodel::strata {

namespace {

constexpr std::size_t kFew = 24;  // up to here looking through all is quickest

}  // namespace

void PlaceHeights::find(PointId point, std::span<std::int32_t> planes) {
    find_distinct(point, planes);
    rank_levels(point);
    const bool few = planes_.size() <= kFew;
    for (std::int32_t& plane : planes) {
        const auto at =
            few ? std::find_if(planes_.begin(), planes_.end(),
                               [&](const Plane& p) { return p.plane == plane; })
                : std::lower_bound(planes_.begin(), planes_.end(), plane,
                                   [](const Plane& p, PlaneId q) { return p.plane < q; });
        plane = levels_[static_cast<std::size_t>(at->level)].rank;
    }
}

void PlaceHeights::find_distinct(PointId point, std::span<const std::int32_t> planes) {
    planes_.clear();
    levels_.clear();
    for (const PlaneId plane : planes) {
        const std::size_t near = std::min(planes_.size(), kFew);
        bool known = false;
        for (std::size_t i = 0; i < near && !known; ++i)
            known = planes_[i].plane == plane;
        if (!known) planes_.push_back({plane, -1});
    }
    // The order in which planes come is left to chance where threads share the work.
    std::sort(planes_.begin(), planes_.end(),
              [](const Plane& a, const Plane& b) { return a.plane < b.plane; });
    if (planes_.size() > kFew) {
        const auto same = [](const Plane& a, const Plane& b) { return a.plane == b.plane; };
        planes_.erase(std::unique(planes_.begin(), planes_.end(), same), planes_.end());
    }
    for (Plane& plane : planes_)
        plane.level = level_of(point, plane.plane);
}

std::int32_t PlaceHeights::level_of(PointId point, PlaneId plane) {
    const auto name = scope_.height_name(plane, point);
    for (std::size_t i = 0; i < std::min(levels_.size(), kFew); ++i) {
        if (levels_[i].name == name) return static_cast<std::int32_t>(i);
    }
    levels_.push_back({name, plane, 0.0, 0});
    return static_cast<std::int32_t>(levels_.size()) - 1;
}

void PlaceHeights::rank_levels(PointId point) {
    std::optional<exact::NearPoint> near;
    for (Level& level : levels_) {
        if (level.name.first >= 0 && level.name.first == level.name.second) {
            level.z = scope_.shared().space(level.name.first).z;
        } else {
            if (!near) near = scope_.near(point);
            level.z = scope_.rounded_height(level.plane, level.name, point, *near);
        }
    }
    const auto level = [&](std::int32_t i) -> Level& {
        return levels_[static_cast<std::size_t>(i)];
    };
    const auto lower = [&](std::int32_t i, std::int32_t j) {
        const Level &a = level(i), &b = level(j);
        if (a.z != b.z) return a.z < b.z;
        return i != j && scope_.compare_heights(b.plane, a.plane, point) > 0;
    };
    order_.resize(levels_.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), lower);  // equally high ones have one rank in any order
    heights_.clear();
    for (std::size_t i = 0; i < order_.size(); ++i) {
        if (i == 0 || lower(order_[i - 1], order_[i])) heights_.push_back(level(order_[i]).z);
        level(order_[i]).rank = static_cast<std::int32_t>(heights_.size()) - 1;
    }
    separate();
}

/// Whether a height is known to be a double: that of an input vertex, of a level edge or plane.
bool PlaceHeights::is_double(std::size_t rank) const {
    const auto& geometry = scope_.shared();
    const auto z = [&](exact::SpaceId s) { return geometry.space(s).z; };
    return std::any_of(levels_.begin(), levels_.end(), [&](const Level& level) {
        if (level.rank != static_cast<std::int32_t>(rank)) return false;
        if (level.name.first >= 0) return z(level.name.first) == z(level.name.second);
        const auto& corner = geometry.plane(level.plane).corner;
        return z(corner[0]) == z(corner[1]) && z(corner[1]) == z(corner[2]);
    });
}

void PlaceHeights::separate() {
    for (std::size_t i = 1; i < heights_.size(); ++i) {
        if (heights_[i] > heights_[i - 1]) continue;
        std::size_t low = i;  // from here to i all are different
        if (is_double(i)) {
            for (; low > 0 && heights_[low - 1] >= heights_[low] && !is_double(low - 1); --low)
                heights_[low - 1] = std::nextafter(heights_[low], -HUGE_VAL);
        }
        // up with all that is left no room below
        for (; low > 0 && low <= i && heights_[low] <= heights_[low - 1]; ++low)
            heights_[low] = std::nextafter(heights_[low - 1], HUGE_VAL);
    }
}

}  // namespace realmodel::strata
