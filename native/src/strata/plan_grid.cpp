// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan_grid.hpp"

#include <algorithm>
#include <cmath>

#include "parallel_chunks.hpp"

namespace realmodel::strata {

PlanBox box_of(const Scope& scope, PolygonView polygon) {
    PlanBox box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const Corner& corner : polygon) {
        const auto& p = scope.point(corner.point);
        box.low_x = std::min(box.low_x, p.x);
        box.high_x = std::max(box.high_x, p.x);
        box.low_y = std::min(box.low_y, p.y);
        box.high_y = std::max(box.high_y, p.y);
    }
    return box;
}

std::int64_t PlanGrid::column(double x) const {
    const double c = (x - frame_.low_x) / step_x_;
    return std::clamp(static_cast<std::int64_t>(std::clamp(c, 0.0, 1e9)), std::int64_t{0},
                      columns_ - 1);
}

std::int64_t PlanGrid::row(double y) const {
    const double r = (y - frame_.low_y) / step_y_;
    return std::clamp(static_cast<std::int64_t>(std::clamp(r, 0.0, 1e9)), std::int64_t{0},
                      rows_ - 1);
}

PlanGrid::PlanGrid(const Scope& scope, const PolygonPool& polygons, const Progress* progress) {
    if (polygons.size() == 0) return;
    frame_ = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    boxes_.reserve(polygons.size());
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        poll(progress, i);
        const PlanBox box = box_of(scope, polygons[i]);
        frame_ = {std::min(frame_.low_x, box.low_x), std::min(frame_.low_y, box.low_y),
                  std::max(frame_.high_x, box.high_x), std::max(frame_.high_y, box.high_y)};
        boxes_.push_back(box);
    }
    const double width = frame_.high_x - frame_.low_x, height = frame_.high_y - frame_.low_y;
    // About one polygon a cell, cells as square as the frame allows.
    const auto count = static_cast<double>(polygons.size());
    const double shape = std::clamp(width / height, 1.0 / count, count);
    columns_ = std::max<std::int64_t>(1, std::llround(std::sqrt(count * shape)));
    rows_ = std::max<std::int64_t>(1, std::llround(std::sqrt(count / shape)));
    step_x_ = std::max(width / static_cast<double>(columns_), 1e-300);
    step_y_ = std::max(height / static_cast<double>(rows_), 1e-300);
    offsets_.assign(static_cast<std::size_t>(columns_ * rows_ + 1), 0);
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        poll(progress, i);
        for_each_cell(scope, polygons[i], boxes_[i],
                      [&](std::int64_t cell) { ++offsets_[static_cast<std::size_t>(cell) + 1]; });
    }
    for (std::size_t c = 1; c < offsets_.size(); ++c)
        offsets_[c] += offsets_[c - 1];
    items_.resize(static_cast<std::size_t>(offsets_.back()));
    std::vector<std::int64_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        poll(progress, i);
        for_each_cell(scope, polygons[i], boxes_[i], [&](std::int64_t cell) {
            items_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell)]++)] =
                static_cast<std::int32_t>(i);
        });
    }
}

template <class Visit>
void PlanGrid::for_each_cell(const Scope& scope, PolygonView polygon, const PlanBox& box,
                             const Visit& visit) const {
    const std::int64_t r0 = row(box.low_y), r1 = row(box.high_y);
    const std::int64_t c0 = column(box.low_x), c1 = column(box.high_x);
    if (c1 - c0 <= 1 || r1 - r0 <= 1) {
        for (std::int64_t r = r0; r <= r1; ++r) {
            for (std::int64_t c = c0; c <= c1; ++c)
                visit(r * columns_ + c);
        }
        return;
    }
    // The stretch of x that the polygon covers in each row, a little too long rather than too
    // short.
    const double slack_x = 0x1p-46 * (std::abs(box.low_x) + std::abs(box.high_x));
    const double slack_y = 0x1p-46 * (std::abs(frame_.low_y) + std::abs(frame_.high_y));
    std::vector<std::array<double, 2>> reach(static_cast<std::size_t>(r1 - r0 + 1),
                                             {HUGE_VAL, -HUGE_VAL});
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto& p = scope.point(polygon[i].point);
        const auto& q = scope.point(polygon[i + 1 < polygon.size() ? i + 1 : 0].point);
        const double low = std::min(p.y, q.y) - slack_y, high = std::max(p.y, q.y) + slack_y;
        for (std::int64_t r = std::max(r0, row(low)), end = std::min(r1, row(high)); r <= end;
             ++r) {
            const double bottom = frame_.low_y + static_cast<double>(r) * step_y_ - slack_y;
            const double top = frame_.low_y + static_cast<double>(r + 1) * step_y_ + slack_y;
            auto& [from, to] = reach[static_cast<std::size_t>(r - r0)];
            const auto include = [&from = from, &to = to](double x) {
                from = std::min(from, x);
                to = std::max(to, x);
            };
            const auto at = [&](double y) {
                const double t = std::clamp((y - p.y) / (q.y - p.y), 0.0, 1.0);
                return p.x + t * (q.x - p.x);
            };
            if (p.y >= bottom && p.y <= top) include(p.x);
            if (q.y >= bottom && q.y <= top) include(q.x);
            if (p.y != q.y) {
                if ((p.y < bottom) != (q.y < bottom)) include(at(bottom));
                if ((p.y > top) != (q.y > top)) include(at(top));
            }
        }
    }
    for (std::int64_t r = r0; r <= r1; ++r) {
        const auto& [from, to] = reach[static_cast<std::size_t>(r - r0)];
        if (from > to) continue;
        for (std::int64_t c = column(from - slack_x), end = column(to + slack_x); c <= end; ++c) {
            visit(r * columns_ + c);
        }
    }
}

void PlanGrid::candidates(const Scope& scope, PolygonView polygon,
                          std::vector<std::int32_t>& found) const {
    found.clear();
    if (items_.empty()) return;
    const PlanBox box = box_of(scope, polygon);
    if (!box.meets(frame_)) return;
    for_each_cell(scope, polygon, box, [&](std::int64_t cell) {
        for (auto i = offsets_[static_cast<std::size_t>(cell)],
                  end = offsets_[static_cast<std::size_t>(cell) + 1];
             i < end; ++i) {
            const std::int32_t item = items_[static_cast<std::size_t>(i)];
            if (boxes_[static_cast<std::size_t>(item)].meets(box)) found.push_back(item);
        }
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

}  // namespace realmodel::strata
