// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/octant_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace realmodel::interpolation {

namespace {

constexpr double points_in_cell = 2;

std::size_t octant(double dx, double dy) {
    return (dx < 0 ? 4U : 0U) + (dy < 0 ? 2U : 0U) + (std::abs(dx) < std::abs(dy) ? 1U : 0U);
}

}  // namespace

OctantSearch::OctantSearch(std::span<const Place> points, const Wanted& wanted)
    : points_(points), wanted_(wanted) {
    Place high = low_ = points[0];
    for (const Place& p : points) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low_[axis] = std::min(low_[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    const auto count = static_cast<double>(points.size());
    const Place extent{high[0] - low_[0], high[1] - low_[1]};
    step_ = std::max(std::sqrt(points_in_cell * extent[0] * extent[1] / count),
                     std::max(extent[0], extent[1]) / count);  // points in one line
    if (!(step_ > 0)) step_ = 1;
    for (std::size_t axis = 0; axis < 2; ++axis)
        cells_[axis] = 1 + static_cast<std::size_t>(extent[axis] / step_);
    const auto cell_of = [&](const Place& p) {
        return static_cast<std::size_t>((p[1] - low_[1]) / step_) * cells_[0] +
               static_cast<std::size_t>((p[0] - low_[0]) / step_);
    };
    first_.assign(cells_[0] * cells_[1] + 1, 0);
    for (const Place& p : points)
        ++first_[cell_of(p) + 1];
    for (std::size_t c = 1; c < first_.size(); ++c)
        first_[c] += first_[c - 1];
    held_.resize(points.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i)
        held_[next[cell_of(points[i])]++] = static_cast<std::int32_t>(i);
}

void OctantSearch::visit(std::size_t column, std::size_t row, const Place& place,
                         std::int32_t left_out) {
    const std::size_t cell = row * cells_[0] + column;
    for (std::size_t k = first_[cell]; k < first_[cell + 1]; ++k) {
        const Place& there = points_[static_cast<std::size_t>(held_[k])];
        const double dx = there[0] - place[0], dy = there[1] - place[1];
        const spatial::Neighbour here{dx * dx + dy * dy, held_[k]};
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
    const auto within = [&](const spatial::Neighbour& n) {
        return n.squared_distance <= squared_distance;
    };
    std::size_t taken = 0;
    for (const auto& octant : taken_)
        taken += static_cast<std::size_t>(std::count_if(octant.begin(), octant.end(), within));
    if (taken >= wanted_.in_all) return true;
    return seen_.size() >= wanted_.looked_at &&
           static_cast<std::size_t>(std::count_if(seen_.begin(), seen_.end(), within)) >=
               wanted_.looked_at;
}

void OctantSearch::find(const Place& place, std::int32_t left_out,
                        std::vector<spatial::Neighbour>& found) {
    seen_.clear();
    for (auto& octant : taken_)
        octant.clear();
    std::array<std::ptrdiff_t, 2> middle{}, last{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        last[axis] = static_cast<std::ptrdiff_t>(cells_[axis]) - 1;
        const double at = std::floor((place[axis] - low_[axis]) / step_);
        middle[axis] =
            at > 0 ? static_cast<std::ptrdiff_t>(std::min(at, static_cast<double>(last[axis]))) : 0;
    }
    for (std::ptrdiff_t ring = 0;; ++ring) {
        const std::ptrdiff_t left = middle[0] - ring, right = middle[0] + ring,
                             bottom = middle[1] - ring, top = middle[1] + ring;
        for (std::ptrdiff_t row = std::max<std::ptrdiff_t>(bottom, 0);
             row <= std::min(top, last[1]); ++row) {
            const bool whole = row == bottom || row == top;
            const std::ptrdiff_t stride = whole || ring == 0 ? 1 : 2 * ring;
            for (std::ptrdiff_t column = left; column <= right; column += stride) {
                if (column < 0 || column > last[0]) continue;
                visit(static_cast<std::size_t>(column), static_cast<std::size_t>(row), place,
                      left_out);
            }
        }
        // What was not looked at lies beyond a side that is not the grid's; a little less for
        // rounding.
        double reach = std::numeric_limits<double>::infinity();
        const auto side = [&](std::size_t axis, std::ptrdiff_t low, std::ptrdiff_t high) {
            const double from = low_[axis] + static_cast<double>(low) * step_;
            const double to = low_[axis] + static_cast<double>(high + 1) * step_;
            if (low > 0) reach = std::min(reach, place[axis] - from);
            if (high < last[axis]) reach = std::min(reach, to - place[axis]);
        };
        side(0, left, right);
        side(1, bottom, top);
        if (std::isinf(reach)) break;
        reach = std::max(0.0, reach - 1e-9 * step_);
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

}  // namespace realmodel::interpolation
