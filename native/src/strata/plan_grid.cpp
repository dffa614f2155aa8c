// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/plan_grid.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel_counts.hpp"
#include "base/sort_few.hpp"

namespace realmodel::strata {

namespace {

/// Worked on at a time. Polygons around a border are few, and each lies in many cells.
constexpr std::size_t kBoxes = 4096, kPolygons = 128;

}  // namespace

PlanBox box_of(const LocalArrangement& scope, PolygonView polygon) {
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
    const double c = (x - grid_.frame.low_x) / grid_.step_x;
    return static_cast<std::int64_t>(std::clamp(c, 0.0, static_cast<double>(grid_.columns - 1)));
}

std::int64_t PolygonCells::row(double y) const {
    const double r = (y - grid_.frame.low_y) / grid_.step_y;
    return static_cast<std::int64_t>(std::clamp(r, 0.0, static_cast<double>(grid_.rows - 1)));
}

void PolygonCells::fill(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
                        const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen,
                        std::size_t cells, int threads, const Progress* progress) {
    if (chosen.empty()) return;
    grid_ = CellGrid(box_around(boxes, chosen), cells);
    offsets_ = zeros<std::uint32_t>(static_cast<std::size_t>(grid_.columns * grid_.rows + 1),
                                    threads, progress);
    // Calls visit(cell, polygon), from several threads.
    const auto for_all = [&](const auto& visit) {
        parallel_ranges(chosen.size(), kPolygons, threads, progress,
                        [&](std::size_t begin, std::size_t end) {
                            const LocalArrangement scope(geometry);
                            for (std::size_t c = begin; c < end; ++c) {
                                const auto i = static_cast<std::size_t>(chosen[c]);
                                for_each_cell(scope, polygons[i], boxes[i], [&](std::int64_t cell) {
                                    visit(static_cast<std::size_t>(cell), chosen[c]);
                                });
                            }
                        });
    };
    for_all([&](std::size_t cell, std::int32_t) { count_one(offsets_[cell]); });
    running_totals(offsets_, UINT32_MAX, threads, progress);
    items_ = FlatArray<Item>(offsets_[offsets_.size() - 1]);
    FlatArray<std::uint32_t> filled = zeros<std::uint32_t>(
        static_cast<std::size_t>(grid_.columns * grid_.rows), threads, progress);
    for_all([&](std::size_t cell, std::int32_t polygon) {
        const PlanBox& box = boxes[static_cast<std::size_t>(polygon)];
        const CellSpan span = span_of(box);
        const bool whole = is_inside(box) && span.is_narrow();
        items_[offsets_[cell] + count_one(filled[cell])] = {
            polygon, whole ? static_cast<std::int32_t>(span.left) : kScattered,
            whole ? static_cast<std::int32_t>(span.low) : kScattered};
    });
}

PolygonCells::CellSpan PolygonCells::span_of(const PlanBox& box) const {
    return {column(box.low_x), column(box.high_x), row(box.low_y), row(box.high_y)};
}

bool PolygonCells::is_inside(const PlanBox& box) const {
    return box.low_x >= grid_.frame.low_x && box.high_x <= grid_.frame.high_x &&
           box.low_y >= grid_.frame.low_y && box.high_y <= grid_.frame.high_y;
}

template <class Visit>
void PolygonCells::for_each_cell(const LocalArrangement& scope, PolygonView polygon,
                                 const PlanBox& box, const Visit& visit) const {
    const CellSpan span = span_of(box);
    const auto [c0, c1, r0, r1] = span;
    if (is_inside(box) && span.is_narrow()) {
        for (std::int64_t r = r0; r <= r1; ++r) {
            for (std::int64_t c = c0; c <= c1; ++c)
                visit(r * grid_.columns + c);
        }
        return;
    }
    // The stretch of x that the polygon covers in each row, a little too long rather than too
    // short.
    const double slack_x = 0x1p-46 * (std::abs(box.low_x) + std::abs(box.high_x));
    const double slack_y = 0x1p-46 * (std::abs(grid_.frame.low_y) + std::abs(grid_.frame.high_y));
    std::vector<std::array<double, 2>> reach(static_cast<std::size_t>(r1 - r0 + 1),
                                             {HUGE_VAL, -HUGE_VAL});
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto& p = scope.point(polygon[i].point);
        const auto& q = scope.point(polygon[i + 1 < polygon.size() ? i + 1 : 0].point);
        const double low = std::min(p.y, q.y) - slack_y, high = std::max(p.y, q.y) + slack_y;
        for (std::int64_t r = std::max(r0, row(low)), end = std::min(r1, row(high)); r <= end;
             ++r) {
            const double bottom =
                grid_.frame.low_y + static_cast<double>(r) * grid_.step_y - slack_y;
            const double top =
                grid_.frame.low_y + static_cast<double>(r + 1) * grid_.step_y + slack_y;
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
        if (from > to || to + slack_x < grid_.frame.low_x || from - slack_x > grid_.frame.high_x)
            continue;
        for (std::int64_t c = column(from - slack_x), end = column(to + slack_x); c <= end; ++c) {
            visit(r * grid_.columns + c);
        }
    }
}

bool PolygonCells::append(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                          const std::vector<PlanBox>& boxes,
                          GrowingArray<std::int32_t>& found) const {
    if (items_.size() == 0 || !box.meets(grid_.frame)) return true;
    const CellSpan span = span_of(box);
    bool is_once = true;
    const auto visit = [&](std::size_t cell, const auto& is_first) {
        for (std::size_t i = offsets_[cell], end = offsets_[cell + 1]; i < end; ++i) {
            const Item& item = items_[i];
            if (!is_first(item)) continue;
            if (!boxes[static_cast<std::size_t>(item.polygon)].meets(box)) continue;
            is_once &= item.left != kScattered;
            found.push_back(item.polygon);
        }
    };
    if (is_inside(box) && span.is_narrow()) {
        for (std::int64_t r = span.low; r <= span.high; ++r) {
            for (std::int64_t c = span.left; c <= span.right; ++c) {
                visit(static_cast<std::size_t>(r * grid_.columns + c), [&](const Item& item) {
                    return item.left == kScattered ||
                           (c == std::max<std::int64_t>(span.left, item.left) &&
                            r == std::max<std::int64_t>(span.low, item.low));
                });
            }
        }
        return is_once;
    }
    for_each_cell(scope, polygon, box, [&](std::int64_t cell) {
        visit(static_cast<std::size_t>(cell), [](const Item&) { return true; });
    });
    return false;
}

PlanGrid::PlanGrid(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
                   const std::vector<std::uint8_t>& is_inner, std::size_t cells, int threads,
                   const Progress* progress) {
    std::vector<std::int32_t> inner, outer;
    for (std::size_t i = 0; i < polygons.size(); ++i)
        (is_inner[i] != 0 ? inner : outer).push_back(static_cast<std::int32_t>(i));
    boxes_.resize(polygons.size());
    parallel_ranges(polygons.size(), kBoxes, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        const LocalArrangement scope(geometry);
                        for (std::size_t i = begin; i < end; ++i)
                            boxes_[i] = box_of(scope, polygons[i]);
                    });
    cells = std::max(cells, polygons.size());
    // of two polygons for a cell, all but the largest are small
    const std::vector<std::int32_t> large =
        small_.fill(boxes_, inner, cells / 2, threads, progress);
    large_.fill(geometry, polygons, boxes_, large, std::min(cells, 8 * large.size()), threads,
                progress);
    // fans of needles around the border: finer cells keep them apart, but each is in many
    outer_.fill(geometry, polygons, boxes_, outer, 8 * outer.size(), threads, progress);
}

void PlanGrid::candidates(const LocalArrangement& scope, PolygonView polygon,
                          GrowingArray<std::int32_t>& found) const {
    found.clear();
    const PlanBox box = box_of(scope, polygon);
    small_.append(box, found);
    bool is_once = large_.append(scope, polygon, box, boxes_, found);
    is_once &= outer_.append(scope, polygon, box, boxes_, found);
    sort_few(found.begin(), found.end());
    if (!is_once)
        found.resize(
            static_cast<std::size_t>(std::unique(found.begin(), found.end()) - found.begin()));
}

}  // namespace realmodel::strata
