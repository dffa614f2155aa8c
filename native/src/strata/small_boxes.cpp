// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/small_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel_counts.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace realmodel::strata {

namespace {

constexpr std::size_t kRange = 8192;

/// Cells that a small box is long at most.
constexpr double kSmall = 2.0;

/// The cell in which something lies, or the nearest there is.
std::int64_t cell_at(double place, std::int64_t count) {
    return static_cast<std::int64_t>(std::clamp(place, 0.0, static_cast<double>(count - 1)));
}

}  // namespace

PlanBox box_around(const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen) {
    PlanBox around{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const std::int32_t i : chosen) {
        const PlanBox& box = boxes[static_cast<std::size_t>(i)];
        around = {std::min(around.low_x, box.low_x), std::min(around.low_y, box.low_y),
                  std::max(around.high_x, box.high_x), std::max(around.high_y, box.high_y)};
    }
    return around;
}

CellGrid::CellGrid(const PlanBox& all, std::size_t cells) : frame(all) {
    const double width = frame.high_x - frame.low_x, height = frame.high_y - frame.low_y;
    const auto count = static_cast<double>(std::max<std::size_t>(cells, 1));
    const double shape = std::clamp(width / height, 1.0 / count, count);
    columns = std::max<std::int64_t>(1, std::llround(std::sqrt(count * shape)));
    rows = std::max<std::int64_t>(1, std::llround(std::sqrt(count / shape)));
    step_x = std::max(width / static_cast<double>(columns), 1e-300);
    step_y = std::max(height / static_cast<double>(rows), 1e-300);
}

SmallBoxes::CellBox SmallBoxes::in_cells(const PlanBox& box) const {
    const auto x = [&](double at) {
        return static_cast<float>((at - grid_.frame.low_x) / grid_.step_x);
    };
    const auto y = [&](double at) {
        return static_cast<float>((at - grid_.frame.low_y) / grid_.step_y);
    };
    return {x(box.low_x), y(box.low_y), x(box.high_x), y(box.high_y)};
}

std::size_t SmallBoxes::cell_of(const CellBox& box) const {
    return static_cast<std::size_t>(cell_at(box.low_y, grid_.rows) * grid_.columns +
                                    cell_at(box.low_x, grid_.columns));
}

std::vector<std::int32_t> SmallBoxes::fill(const std::vector<PlanBox>& boxes,
                                           const std::vector<std::int32_t>& chosen,
                                           std::size_t cells, int threads,
                                           const Progress* progress) {
    if (chosen.empty()) return {};
    grid_ = CellGrid(box_around(boxes, chosen), cells);
    offsets_ = zeros<std::uint32_t>(static_cast<std::size_t>(grid_.columns * grid_.rows + 1),
                                    threads, progress);
    const auto box_in_cells = [&](std::size_t c) {
        return in_cells(boxes[static_cast<std::size_t>(chosen[c])]);
    };
    constexpr std::uint32_t kOther = UINT32_MAX;
    FlatArray<std::uint32_t> within(chosen.size());  // its cell; kOther: not small
    struct Part {
        double reach_x = 0, reach_y = 0;
        std::vector<std::int32_t> others;
    };
    std::vector<Part> parts((chosen.size() + kRange - 1) / kRange);
    parallel_ranges(chosen.size(), kRange, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        Part& part = parts[begin / kRange];
                        for (std::size_t c = begin; c < end; ++c) {
                            const CellBox box = box_in_cells(c);
                            const double width = static_cast<double>(box.high_x) - box.low_x;
                            const double height = static_cast<double>(box.high_y) - box.low_y;
                            if (width > kSmall || height > kSmall) {
                                part.others.push_back(chosen[c]);
                                within[c] = kOther;
                                continue;
                            }
                            part.reach_x = std::max(part.reach_x, width);
                            part.reach_y = std::max(part.reach_y, height);
                            within[c] = count_one(offsets_[cell_of(box)]);
                        }
                    });
    std::vector<std::int32_t> others;
    for (const Part& part : parts) {
        reach_x_ = std::max(reach_x_, part.reach_x);
        reach_y_ = std::max(reach_y_, part.reach_y);
        others.insert(others.end(), part.others.begin(), part.others.end());
    }
    running_totals(offsets_, UINT32_MAX, threads, progress);
    items_ = FlatArray<Item>(chosen.size() - others.size());
    parallel_ranges(chosen.size(), kRange, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c) {
                            if (within[c] == kOther) continue;
                            const CellBox box = box_in_cells(c);
                            items_[offsets_[cell_of(box)] + within[c]] = {
                                {box.low_x, box.low_y, -box.high_x, -box.high_y}, chosen[c]};
                        }
                    });
    return others;
}

inline std::uint32_t SmallBoxes::meets(const Item& item, const Limits& limits) {
#if defined(__SSE__)
    const __m128 within =
        _mm_cmple_ps(_mm_loadu_ps(item.corners.data()), _mm_loadu_ps(limits.data()));
    return _mm_movemask_ps(within) == 15 ? 1 : 0;
#else
    const auto& [a, b, c, d] = item.corners;
    return static_cast<std::uint32_t>((a <= limits[0]) & (b <= limits[1]) & (c <= limits[2]) &
                                      (d <= limits[3]));
#endif
}

void SmallBoxes::append(const PlanBox& box, GrowingArray<std::int32_t>& found) const {
    if (items_.size() == 0 || !box.meets(grid_.frame)) return;
    const CellBox own = in_cells(box);
    const Limits limits{own.high_x, own.high_y, -own.low_x, -own.low_y};
    const std::int64_t left = cell_at(own.low_x - reach_x_, grid_.columns);
    const std::int64_t right = cell_at(own.high_x, grid_.columns);
    const std::int64_t low = cell_at(own.low_y - reach_y_, grid_.rows);
    const std::int64_t high = cell_at(own.high_y, grid_.rows);
    for (std::int64_t row = low; row <= high; ++row) {
        // the cells of a row lie side by side
        const Item* item = items_.begin() + offsets_[row * grid_.columns + left];
        const Item* end = items_.begin() + offsets_[row * grid_.columns + right + 1];
        const std::size_t before = found.size();
        found.resize(before + static_cast<std::size_t>(end - item));
        std::int32_t* next = found.data() + before;
        for (; item != end; ++item) {
            *next = item->number;
            next += meets(*item, limits);
        }
        found.resize(static_cast<std::size_t>(next - found.data()));
    }
}

}  // namespace realmodel::strata
