// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/vertex_heights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace realmodel::strata {

namespace {

constexpr std::size_t kFew = 24;  // up to here looking through all is quickest

}  // namespace

void VertexHeights::find(PointId point, std::span<std::int32_t> planes) {
    if (find_single(point, planes)) return;
    find_distinct(point, planes);
    rank_levels(point);
    if (!tentative_.empty()) settle_tentative(point);
    separate();
    for (std::int32_t& code : planes) {
        const PlaneId plane = plane_of(code);
        if (!is_tentative(code)) {
            code = rank_of(plane);
            continue;
        }
        const auto at = std::find_if(tentative_.begin(), tentative_.end(),
                                     [&](const Plane& p) { return p.plane == plane; });
        code = at->level < 0 ? -1 : levels_[static_cast<std::size_t>(at->level)].rank;
    }
}

/// Where what the plan vertex is made of tells that all planes are equally high, as on most plan
/// vertices, there is nothing to put in order.
/// @return whether that is so, and all is done
bool VertexHeights::find_single(PointId point, std::span<std::int32_t> planes) {
    if (planes.empty() || is_tentative(planes[0])) return false;
    const PlaneId first = plane_of(planes[0]);
    Level level{scope_.height_name(first, point), first, 0.0, 0};
    std::array known{planes[0], planes[0]};
    for (const std::int32_t code : planes.subspan(1)) {
        if (code == known[0] || code == known[1]) continue;
        if (is_tentative(code)) return false;
        const PlaneId plane = plane_of(code);
        if (scope_.height_name(plane, point) != level.name) return false;
        known = {code, known[0]};
        level.plane = std::min(level.plane, plane);
    }
    std::optional<exact::NearPoint> near;
    heights_.assign(1, rounded(level, point, near));
    std::fill(planes.begin(), planes.end(), 0);
    return true;
}

std::int32_t VertexHeights::rank_of(PlaneId plane) const {
    const auto at = planes_.size() <= kFew
                        ? std::find_if(planes_.begin(), planes_.end(),
                                       [&](const Plane& p) { return p.plane == plane; })
                        : std::lower_bound(planes_.begin(), planes_.end(), plane,
                                           [](const Plane& p, PlaneId q) { return p.plane < q; });
    return levels_[static_cast<std::size_t>(at->level)].rank;
}

void VertexHeights::find_distinct(PointId point, std::span<const std::int32_t> planes) {
    planes_.clear();
    tentative_.clear();
    levels_.clear();
    for (const std::int32_t code : planes) {
        std::vector<Plane>& kind = is_tentative(code) ? tentative_ : planes_;
        const PlaneId plane = plane_of(code);
        const std::size_t near = is_tentative(code) ? kind.size() : std::min(kind.size(), kFew);
        bool known = false;
        for (std::size_t i = 0; i < near && !known; ++i)
            known = kind[i].plane == plane;
        if (!known) kind.push_back({plane, -1});
    }
    // The order in which planes come is left to chance where threads share the work.
    const auto in_order = [](const Plane& a, const Plane& b) { return a.plane < b.plane; };
    std::sort(planes_.begin(), planes_.end(), in_order);
    std::sort(tentative_.begin(), tentative_.end(), in_order);
    if (planes_.size() > kFew) {
        const auto same = [](const Plane& a, const Plane& b) { return a.plane == b.plane; };
        planes_.erase(std::unique(planes_.begin(), planes_.end(), same), planes_.end());
    }
    for (Plane& plane : planes_)
        plane.level = level_of(point, plane.plane);
}

/// Whether a plane is as high as one of some levels, or so near that this would have to be asked
/// exactly. There is room between what takes up a vertex here and what passes by.
bool VertexHeights::is_near(PointId id, PlaneId plane, std::span<const Level> levels) const {
    const exact::PlanArrangement& geometry = scope_.shared();
    const exact::SpaceVertex& corner = geometry.space(geometry.plane(plane).corner[0]);
    const exact::Point &from = geometry.point(corner.plan), &to = geometry.point(id);
    const exact::PlaneFilter& gradient = geometry.plane_filter(plane);
    const double dx = to.x - from.x, dy = to.y - from.y;
    const double rise_x = gradient.gx * dx, rise_y = gradient.gy * dy;
    const double z = corner.z + rise_x + rise_y;
    const double size = std::abs(corner.z) + std::abs(rise_x) + std::abs(rise_y);
    const double error = gradient.error_x * std::abs(dx) + gradient.error_y * std::abs(dy) +
                         (std::abs(gradient.gx) + std::abs(gradient.gy)) * to.error() +
                         exact::kPlaneHeight * size + exact::kTermUnderflow;
    return std::any_of(levels.begin(), levels.end(), [&](const Level& level) {
        const double margin =
            exact::kFarTimes * error + geometry.clear_height(size + std::abs(level.z));
        return !(std::abs(z - level.z) > margin);
    });
}

/// Gives tentative planes the level that they take up, if there is one. A plane that counts after
/// all may be near to the next, so they are asked until none is.
void VertexHeights::settle_tentative(PointId point) {
    for (bool again = true; again;) {
        again = false;
        const std::size_t known = levels_.size();
        for (Plane& plane : tentative_) {
            if (plane.level >= 0 || !is_near(point, plane.plane, {levels_.data(), known})) continue;
            plane.level = level_of(point, plane.plane);
            again = true;
        }
        if (levels_.size() > known) rank_levels(point);
    }
}

std::int32_t VertexHeights::level_of(PointId point, PlaneId plane) {
    const auto name = scope_.height_name(plane, point);
    for (std::size_t i = 0; i < std::min(levels_.size(), kFew); ++i) {
        if (levels_[i].name == name) return static_cast<std::int32_t>(i);
    }
    levels_.push_back({name, plane, 0.0, 0});
    return static_cast<std::int32_t>(levels_.size()) - 1;
}

/// @param near  where the point lies, found for the first level that asks for it
double VertexHeights::rounded(const Level& level, PointId point,
                              std::optional<exact::NearPoint>& near) {
    if (level.name.is_edge() && level.name.from() == level.name.to())
        return scope_.shared().space(level.name.from()).z;
    if (const auto z = scope_.rounded_height_of_crossing(level.name, point)) return *z;
    if (!near) near = scope_.near(point);
    return scope_.rounded_height(level.plane, level.name, point, *near);
}

void VertexHeights::rank_levels(PointId point) {
    std::optional<exact::NearPoint> near;
    for (Level& level : levels_)
        level.z = rounded(level, point, near);
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
}

/// Whether a height is known to be a double: that of an input vertex, of a level edge or plane.
bool VertexHeights::is_double(std::size_t rank) const {
    const auto& geometry = scope_.shared();
    const auto z = [&](exact::SpaceId s) { return geometry.space(s).z; };
    return std::any_of(levels_.begin(), levels_.end(), [&](const Level& level) {
        if (level.rank != static_cast<std::int32_t>(rank)) return false;
        if (level.name.is_edge()) return z(level.name.from()) == z(level.name.to());
        const auto& corner = geometry.plane(level.plane).corner;
        return z(corner[0]) == z(corner[1]) && z(corner[1]) == z(corner[2]);
    });
}

void VertexHeights::separate() {
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
