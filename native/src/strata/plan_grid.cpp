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

std::int64_t PolygonCells::column(double x) const {
    const double c = (x - frame_.low_x) / step_x_;
    return std::clamp(static_cast<std::int64_t>(std::clamp(c, 0.0, 1e9)), std::int64_t{0},
                      columns_ - 1);
}

std::int64_t PolygonCells::row(double y) const {
    const double r = (y - frame_.low_y) / step_y_;
    return std::clamp(static_cast<std::int64_t>(std::clamp(r, 0.0, 1e9)), std::int64_t{0},
                      rows_ - 1);
}

void PolygonCells::fill(const Scope& scope, const PolygonPool& polygons,
                        const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen,
                        std::size_t cells, const Progress* progress) {
    if (chosen.empty()) return;
    frame_ = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const std::int32_t i : chosen) {
        const PlanBox& box = boxes[static_cast<std::size_t>(i)];
        frame_ = {std::min(frame_.low_x, box.low_x), std::min(frame_.low_y, box.low_y),
                  std::max(frame_.high_x, box.high_x), std::max(frame_.high_y, box.high_y)};
    }
    const double width = frame_.high_x - frame_.low_x, height = frame_.high_y - frame_.low_y;
    // cells as square as the frame allows
    const auto count = static_cast<double>(std::max<std::size_t>(cells, 1));
    const double shape = std::clamp(width / height, 1.0 / count, count);
    columns_ = std::max<std::int64_t>(1, std::llround(std::sqrt(count * shape)));
    rows_ = std::max<std::int64_t>(1, std::llround(std::sqrt(count / shape)));
    step_x_ = std::max(width / static_cast<double>(columns_), 1e-300);
    step_y_ = std::max(height / static_cast<double>(rows_), 1e-300);
    offsets_.assign(static_cast<std::size_t>(columns_ * rows_ + 1), 0);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        poll(progress, c);
        const auto i = static_cast<std::size_t>(chosen[c]);
        for_each_cell(scope, polygons[i], boxes[i],
                      [&](std::int64_t cell) { ++offsets_[static_cast<std::size_t>(cell) + 1]; });
    }
    for (std::size_t c = 1; c < offsets_.size(); ++c)
        offsets_[c] += offsets_[c - 1];
    items_.resize(static_cast<std::size_t>(offsets_.back()));
    std::vector<std::int64_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        poll(progress, c);
        const auto i = static_cast<std::size_t>(chosen[c]);
        for_each_cell(scope, polygons[i], boxes[i], [&](std::int64_t cell) {
            items_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell)]++)] = chosen[c];
        });
    }
}

template <class Visit>
void PolygonCells::for_each_cell(const Scope& scope, PolygonView polygon, const PlanBox& box,
                                 const Visit& visit) const {
    const std::int64_t r0 = row(box.low_y), r1 = row(box.high_y);
    const std::int64_t c0 = column(box.low_x), c1 = column(box.high_x);
    const bool inside = box.low_x >= frame_.low_x && box.high_x <= frame_.high_x &&
                        box.low_y >= frame_.low_y && box.high_y <= frame_.high_y;
    if (inside && (c1 - c0 <= 1 || r1 - r0 <= 1)) {
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
        if (from > to || to + slack_x < frame_.low_x || from - slack_x > frame_.high_x) continue;
        for (std::int64_t c = column(from - slack_x), end = column(to + slack_x); c <= end; ++c) {
            visit(r * columns_ + c);
        }
    }
}

void PolygonCells::append(const Scope& scope, PolygonView polygon, const PlanBox& box,
                          const std::vector<PlanBox>& boxes,
                          std::vector<std::int32_t>& found) const {
    if (items_.empty() || !box.meets(frame_)) return;
    for_each_cell(scope, polygon, box, [&](std::int64_t cell) {
        for (auto i = offsets_[static_cast<std::size_t>(cell)],
                  end = offsets_[static_cast<std::size_t>(cell) + 1];
             i < end; ++i) {
            const std::int32_t item = items_[static_cast<std::size_t>(i)];
            if (boxes[static_cast<std::size_t>(item)].meets(box)) found.push_back(item);
        }
    });
}

PlanGrid::PlanGrid(const Scope& scope, const PolygonPool& polygons,
                   const std::vector<std::uint8_t>& is_inner, std::size_t cells,
                   const Progress* progress) {
    std::vector<std::int32_t> inner, outer;
    boxes_.reserve(polygons.size());
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        poll(progress, i);
        boxes_.push_back(box_of(scope, polygons[i]));
        (is_inner[i] != 0 ? inner : outer).push_back(static_cast<std::int32_t>(i));
    }
    cells = std::max(cells, polygons.size());
    inner_.fill(scope, polygons, boxes_, inner, cells, progress);
    // fans of needles around the border: fine cells keep them apart
    outer_.fill(scope, polygons, boxes_, outer, cells, progress);
}

void PlanGrid::candidates(const Scope& scope, PolygonView polygon,
                          std::vector<std::int32_t>& found) const {
    found.clear();
    const PlanBox box = box_of(scope, polygon);
    inner_.append(scope, polygon, box, boxes_, found);
    outer_.append(scope, polygon, box, boxes_, found);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

}  // namespace realmodel::strata
