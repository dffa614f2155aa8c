// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/octant_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"

namespace realmodel::spatial {

namespace {

constexpr std::size_t kPointsInTile = 2;

std::size_t octant(double dx, double dy) {
    return (dx < 0 ? 4U : 0U) + (dy < 0 ? 2U : 0U) + (std::abs(dx) < std::abs(dy) ? 1U : 0U);
}

}  // namespace

OctantSearch::OctantSearch(std::span<const PlanPosition> points, const Wanted& wanted)
    : points_(points),
      wanted_(wanted),
      tiles_(box_around(points), points.size() / kPointsInTile),
      points_at_(bucketize<std::int32_t>(tiles_.size(), [&](const auto& put) {
          for (std::size_t i = 0; i < points.size(); ++i)
              put(tiles_.tile_at(points[i]), static_cast<std::int32_t>(i));
      })) {}

void OctantSearch::visit(std::size_t tile, const PlanPosition& position, std::int32_t left_out) {
    for (const std::int32_t point : points_at_[tile]) {
        const PlanPosition& there = points_[index(point)];
        const double dx = there[0] - position[0], dy = there[1] - position[1];
        const Neighbor here{dx * dx + dy * dy, point};
        seen_.push_back(here);
        if (here.point == left_out || here.squared_distance > wanted_.squared_radius) continue;
        auto& taken = taken_[octant(dx, dy)];
        if (taken.size() == wanted_.in_octant && taken.back() < here) continue;
        if (taken.size() == wanted_.in_octant) taken.pop_back();
        taken.insert(std::upper_bound(taken.begin(), taken.end(), here), here);
    }
}

bool OctantSearch::complete(double squared_distance) const {
    if (squared_distance > wanted_.squared_radius) return true;
    const auto within = [&](const Neighbor& n) { return n.squared_distance <= squared_distance; };
    std::size_t taken = 0;
    for (const auto& octant : taken_)
        taken += static_cast<std::size_t>(std::count_if(octant.begin(), octant.end(), within));
    if (taken >= wanted_.in_all) return true;
    return seen_.size() >= wanted_.looked_at &&
           static_cast<std::size_t>(std::count_if(seen_.begin(), seen_.end(), within)) >=
               wanted_.looked_at;
}

void OctantSearch::find(const PlanPosition& position, std::int32_t left_out,
                        std::vector<Neighbor>& found) {
    seen_.clear();
    for (auto& octant : taken_)
        octant.clear();
    const PlanBox& frame = tiles_.frame();
    const auto columns = static_cast<std::int32_t>(tiles_.columns());
    const auto rows = static_cast<std::int32_t>(tiles_.rows());
    const std::int32_t column = tiles_.column(position[0]), row = tiles_.row(position[1]);
    for (std::int32_t ring = 0;; ++ring) {
        const TileSpan span{column - ring, column + ring, row - ring, row + ring};
        for (std::int32_t r = std::max(span.low, 0); r <= std::min(span.high, rows - 1); ++r) {
            const bool is_whole = r == span.low || r == span.high;
            const std::int32_t stride = is_whole ? 1 : 2 * ring;
            for (std::int32_t c = span.left; c <= span.right; c += stride) {
                if (c >= 0 && c < columns) visit(tiles_.tile(c, r), position, left_out);
            }
        }
        // What was not looked at lies beyond a side that is not the frame's; a little less for
        // rounding.
        double reach = std::numeric_limits<double>::infinity();
        const auto side = [&](double at, double low, double step, std::int32_t from,
                              std::int32_t to, std::int32_t count) {
            if (from > 0) reach = std::min(reach, at - (low + from * step) - 1e-9 * step);
            if (to < count - 1) reach = std::min(reach, low + (to + 1) * step - at - 1e-9 * step);
        };
        side(position[0], frame.low_x, tiles_.step_x(), span.left, span.right, columns);
        side(position[1], frame.low_y, tiles_.step_y(), span.low, span.high, rows);
        if (std::isinf(reach)) break;
        reach = std::max(0.0, reach);
        if (complete(reach * reach)) break;
    }
    found.clear();
    for (const auto& octant : taken_)
        found.insert(found.end(), octant.begin(), octant.end());
    std::sort(found.begin(), found.end());
    if (seen_.size() > wanted_.looked_at) {
        const auto last_one = seen_.begin() + static_cast<std::ptrdiff_t>(wanted_.looked_at - 1);
        std::nth_element(seen_.begin(), last_one, seen_.end());
        found.erase(std::upper_bound(found.begin(), found.end(), *last_one), found.end());
    }
    if (found.size() > wanted_.in_all) found.resize(wanted_.in_all);
}

}  // namespace realmodel::spatial
