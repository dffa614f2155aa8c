// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/small_boxes.hpp"

#include <algorithm>

#include "base/index.hpp"

#if defined(__SSE__) && !defined(REALMODEL_PLAIN_DOUBLE)
#include <xmmintrin.h>
#endif

namespace realmodel::spatial {

namespace {

constexpr std::size_t kRange = 8192;

/// Cells that a small box is long at most.
constexpr double kSmall = 2.0;

}  // namespace

PlanBox box_around(const std::vector<PlanBox>& boxes, const std::vector<std::int32_t>& chosen) {
    PlanBox around = kNoBox;
    for (const std::int32_t i : chosen)
        around = around.united(boxes[static_cast<std::size_t>(i)]);
    return around;
}

SmallBoxes::CellBox SmallBoxes::in_cells(const PlanBox& box) const {
    const PlanBox& frame = cells_.frame();
    const auto x = [&](double at) {
        return static_cast<float>((at - frame.low_x) / cells_.step_x());
    };
    const auto y = [&](double at) {
        return static_cast<float>((at - frame.low_y) / cells_.step_y());
    };
    return {x(box.low_x), y(box.low_y), x(box.high_x), y(box.high_y)};
}

std::vector<std::int32_t> SmallBoxes::fill(const std::vector<PlanBox>& boxes,
                                           const std::vector<std::int32_t>& chosen,
                                           std::size_t cells, const Execution& execution) {
    if (chosen.empty()) return {};
    cells_ = PlanTiles(box_around(boxes, chosen), cells);
    struct Part {
        double reach_x = 0, reach_y = 0;
        std::vector<std::int32_t> others;
    };
    std::vector<Part> parts((chosen.size() + kRange - 1) / kRange);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        Part part;
        for (std::size_t c = chunk * kRange, end = std::min(chosen.size(), c + kRange); c < end;
             ++c) {
            const CellBox box = in_cells(boxes[index(chosen[c])]);
            const double width = static_cast<double>(box.high_x) - box.low_x;
            const double height = static_cast<double>(box.high_y) - box.low_y;
            if (width > kSmall || height > kSmall) {
                part.others.push_back(chosen[c]);
                continue;
            }
            part.reach_x = std::max(part.reach_x, width);
            part.reach_y = std::max(part.reach_y, height);
            put(cells_.tile(cells_.nearest_column(box.low_x), cells_.nearest_row(box.low_y)),
                Item{{box.low_x, box.low_y, -box.high_x, -box.high_y}, chosen[c]});
        }
        parts[chunk] = std::move(part);
    };
    items_ = bucketize_in_any_order<Item>(cells_.size(), parts.size(), produce, execution);
    std::vector<std::int32_t> others;
    for (const Part& part : parts) {
        reach_x_ = std::max(reach_x_, part.reach_x);
        reach_y_ = std::max(reach_y_, part.reach_y);
        others.insert(others.end(), part.others.begin(), part.others.end());
    }
    return others;
}

inline std::uint32_t SmallBoxes::meets(const Item& item, const Limits& limits) {
#if defined(__SSE__) && !defined(REALMODEL_PLAIN_DOUBLE)
    const __m128 within =
        _mm_cmple_ps(_mm_loadu_ps(item.corners.data()), _mm_loadu_ps(limits.data()));
    return _mm_movemask_ps(within) == 15 ? 1 : 0;
#else
    const auto& [a, b, c, d] = item.corners;
    return std::uint32_t{a <= limits[0]} & std::uint32_t{b <= limits[1]} &
           std::uint32_t{c <= limits[2]} & std::uint32_t{d <= limits[3]};
#endif
}

void SmallBoxes::append(const PlanBox& box, Array<std::int32_t>& found) const {
    if (items_.values.empty() || !box.meets(cells_.frame())) return;
    const CellBox own = in_cells(box);
    const Limits limits{own.high_x, own.high_y, -own.low_x, -own.low_y};
    const std::int32_t left = cells_.nearest_column(own.low_x - reach_x_);
    const std::int32_t right = cells_.nearest_column(own.high_x);
    const std::int32_t low = cells_.nearest_row(own.low_y - reach_y_);
    const std::int32_t high = cells_.nearest_row(own.high_y);
    for (std::int32_t row = low; row <= high; ++row) {
        // the cells of a row lie side by side
        const Item* item = items_.values.data() + items_.offsets[cells_.tile(left, row)];
        const Item* end = items_.values.data() + items_.offsets[cells_.tile(right, row) + 1];
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

}  // namespace realmodel::spatial
