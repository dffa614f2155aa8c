// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/plan_grid.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/index.hpp"

namespace realmodel::strata {

namespace {

/// Worked on at a time. Polygons around a border are few, and each lies in many cells.
constexpr std::size_t kBoxes = 4096, kPolygons = 128;

bool is_narrow(const TileSpan& span) {
    return span.right - span.left <= 1 || span.high - span.low <= 1;
}

constexpr double kNear = 1e-6;  // of a cell: what is only beside a cell counts as in it

}  // namespace

PlanBox box_of(const LocalArrangement& scope, PolygonView polygon) {
    PlanBox box = spatial::kNoBox;
    for (const Corner& corner : polygon) {
        const auto& p = scope.point(corner.point);
        box = box.united({p.x, p.y, p.x, p.y});
    }
    return box;
}

void PolygonCells::fill(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
                        const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen,
                        std::size_t cells, const Execution& execution) {
    if (chosen.empty()) return;
    PlanBox frame = spatial::kNoBox;
    for (const std::int32_t i : chosen)
        frame = frame.united(boxes[index(i)]);
    cells_ = PlanTiles(frame, cells);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const LocalArrangement scope(geometry);
        for (std::size_t c = chunk * kPolygons, end = std::min(chosen.size(), c + kPolygons);
             c < end; ++c) {
            const auto i = index(chosen[c]);
            const TileSpan span = cells_.span(boxes[i]);
            const bool whole = is_inside(boxes[i]) && is_narrow(span);
            const CellPolygon item{chosen[c], whole ? span.left : kScattered,
                                   whole ? span.low : kScattered};
            for_each_cell(scope, polygons[i], boxes[i], [&](std::size_t cell) { put(cell, item); });
        }
    };
    items_ = bucketize_in_any_order<CellPolygon>(
        cells_.size(), (chosen.size() + kPolygons - 1) / kPolygons, produce, execution);
}

bool PolygonCells::is_inside(const PlanBox& box) const {
    const PlanBox& frame = cells_.frame();
    return box.low_x >= frame.low_x && box.high_x <= frame.high_x && box.low_y >= frame.low_y &&
           box.high_y <= frame.high_y;
}

template <class Visit>
void PolygonCells::for_each_cell(const LocalArrangement& scope, PolygonView polygon,
                                 const PlanBox& box, const Visit& visit) const {
    const TileSpan span = cells_.span(box);
    if (is_inside(box) && is_narrow(span)) {
        cells_.for_each(span, visit);
        return;
    }
    const PlanBox& frame = cells_.frame();
    // The stretch of x that the polygon covers in each row, a little too long rather than too
    // short.
    const double slack_x = 0x1p-46 * (std::abs(box.low_x) + std::abs(box.high_x));
    const double slack_y = 0x1p-46 * (std::abs(frame.low_y) + std::abs(frame.high_y));
    std::vector<std::array<double, 2>> reach(index(span.high - span.low + 1),
                                             {HUGE_VAL, -HUGE_VAL});
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto& p = scope.point(polygon[i].point);
        const auto& q = scope.point(polygon[i + 1 < polygon.size() ? i + 1 : 0].point);
        const double low = std::min(p.y, q.y) - slack_y, high = std::max(p.y, q.y) + slack_y;
        const std::int32_t last = std::min(span.high, cells_.row(high));
        for (std::int32_t r = std::max(span.low, cells_.row(low)); r <= last; ++r) {
            const double bottom = frame.low_y + r * cells_.step_y() - slack_y;
            const double top = frame.low_y + (r + 1.0) * cells_.step_y() + slack_y;
            auto& [from, to] = reach[index(r - span.low)];
            const auto include = [&least = from, &most = to](double x) {
                least = std::min(least, x);
                most = std::max(most, x);
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
    for (std::int32_t r = span.low; r <= span.high; ++r) {
        const auto& [from, to] = reach[index(r - span.low)];
        if (from > to || to + slack_x < frame.low_x || from - slack_x > frame.high_x) continue;
        const std::int32_t last = cells_.column(to + slack_x);
        for (std::int32_t c = cells_.column(from - slack_x); c <= last; ++c)
            visit(cells_.tile(c, r));
    }
}

bool PolygonCells::append(const LocalArrangement& scope, PolygonView polygon, const PlanBox& box,
                          const std::vector<PlanBox>& boxes, Array<std::int32_t>& numbers) const {
    if (items_.values.empty() || !box.meets(cells_.frame())) return true;
    const TileSpan span = cells_.span(box);
    bool is_once = true;
    const auto visit = [&](std::size_t cell, const auto& is_first) {
        for (const CellPolygon& item : items_[cell]) {
            if (!is_first(item)) continue;
            if (!boxes[index(item.polygon)].meets(box)) continue;
            is_once &= item.left != kScattered;
            numbers.push_back(item.polygon);
        }
    };
    if (is_inside(box) && is_narrow(span)) {
        for (std::int32_t r = span.low; r <= span.high; ++r) {
            for (std::int32_t c = span.left; c <= span.right; ++c) {
                visit(cells_.tile(c, r), [&](const CellPolygon& item) {
                    return item.left == kScattered || (c == std::max(span.left, item.left) &&
                                                       r == std::max(span.low, item.low));
                });
            }
        }
        return is_once;
    }
    for_each_cell(scope, polygon, box,
                  [&](std::size_t cell) { visit(cell, [](const CellPolygon&) { return true; }); });
    return false;
}

PlanGrid::PlanGrid(const exact::PlanArrangement& geometry, const PolygonPool& polygons,
                   const std::vector<std::uint8_t>& is_inner, std::size_t cells,
                   const Execution& execution) {
    std::vector<std::int32_t> inner, outer;
    for (std::size_t i = 0; i < polygons.size(); ++i)
        (is_inner[i] != 0 ? inner : outer).push_back(static_cast<std::int32_t>(i));
    boxes_.resize(polygons.size());
    parallel_ranges(polygons.size(), kBoxes, execution, [&](std::size_t begin, std::size_t end) {
        const LocalArrangement scope(geometry);
        for (std::size_t i = begin; i < end; ++i)
            boxes_[i] = box_of(scope, polygons[i]);
    });
    cells = std::max(cells, polygons.size());
    inner_.fill(geometry, polygons, boxes_, inner, cells / 4, execution);
    // fans of needles around the border: finer cells keep them apart, but each is in many
    outer_.fill(geometry, polygons, boxes_, outer, 8 * outer.size(), execution);
}

void PlanGrid::candidates(const LocalArrangement& scope, PolygonView polygon,
                          Array<std::int32_t>& numbers) const {
    numbers.clear();
    const PlanBox box = box_of(scope, polygon);
    bool is_once = inner_.append(scope, polygon, box, boxes_, numbers);
    is_once &= outer_.append(scope, polygon, box, boxes_, numbers);
    std::sort(numbers.begin(), numbers.end());
    if (!is_once)
        numbers.resize(static_cast<std::size_t>(std::unique(numbers.begin(), numbers.end()) -
                                                numbers.begin()));
}

WantedBoxes::WantedBoxes(const WantedSpace& space) : space_(space) {
    const auto [nx, ny, nz] = space.cells;
    assert(nz <= kMostLayers && space.is_wanted.size() == nx * ny * nz);
    layers_.resize(nx * ny, 0);
    for (std::size_t i = 0; i < space.is_wanted.size(); ++i) {
        if (space.is_wanted[i] != 0) layers_[i / nz] |= std::uint64_t{1} << (i % nz);
    }
}

bool WantedBoxes::any_in(const spatial::Box& box) const {
    const double top = space_.low[2] + space_.step[2] * static_cast<double>(space_.cells[2]);
    if (box.low[2] < space_.low[2] || box.high[2] > top) return true;
    const double beside = kNear * space_.step[2];
    const std::uint64_t layers =
        layers_up_to(box.high[2] + beside) & ~(layers_up_to(box.low[2] - beside) >> 1);
    std::array<std::size_t, 2> first{}, last{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double near = kNear * space_.step[axis];
        first[axis] = cell(axis, box.low[axis] - near);
        last[axis] = cell(axis, box.high[axis] + near);
    }
    for (std::size_t x = first[0]; x <= last[0]; ++x) {
        for (std::size_t y = first[1]; y <= last[1]; ++y) {
            if ((layers_[x * space_.cells[1] + y] & layers) != 0) return true;
        }
    }
    return false;
}

/// The layer of a height and those beneath it.
std::uint64_t WantedBoxes::layers_up_to(double height) const {
    return ~std::uint64_t{0} >> (kMostLayers - 1 - cell(2, height));
}

std::size_t WantedBoxes::cell(std::size_t axis, double coordinate) const {
    const double at = std::floor((coordinate - space_.low[axis]) / space_.step[axis]);
    return static_cast<std::size_t>(
        std::clamp(at, 0.0, static_cast<double>(space_.cells[axis] - 1)));
}

}  // namespace realmodel::strata
