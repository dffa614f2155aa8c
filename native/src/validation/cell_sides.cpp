// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_sides.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel_sort.hpp"
#include "validation/face_shape.hpp"
#include "validation/findings.hpp"

namespace realmodel::validation {

SidesByCell::SidesByCell(const ComplexView& model, const Execution& execution) {
    const std::size_t sides = model.face_cells.size(), cells = model.cell_count();
    const auto produce = [&](std::size_t chunk, const auto& put) {
        for (std::size_t i = chunk * kItemsOfChunk, end = std::min(sides, i + kItemsOfChunk);
             i < end; ++i) {
            const std::int32_t cell = model.face_cells[i];
            if (cell >= 0) put(index(cell), static_cast<Side>(i));
        }
    };
    const std::size_t chunks = (sides + kItemsOfChunk - 1) / kItemsOfChunk;
    Buckets<Side>::operator=(sorted_in_buckets<Side>(cells, chunks, produce, execution));
}

CellExtent::CellExtent(const ComplexView& model, std::span<const Side> sides) {
    low_.fill(HUGE_VAL);
    high_.fill(-HUGE_VAL);
    for (const Side side : sides) {
        for (const std::int32_t v : model.face(face_of(side))) {
            const auto p = model.vertex(v);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low_[axis] = std::min(low_[axis], p[axis]);
                high_[axis] = std::max(high_[axis], p[axis]);
            }
        }
    }
}

bool CellExtent::is_flat() const {
    return low_[0] == high_[0] || low_[1] == high_[1] || low_[2] == high_[2];
}

// What moves by a step in x sweeps no more than the cell is wide in y and high in z, and so on.
double CellExtent::volume_rounding() const {
    std::array<double, 3> size, step;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        step[axis] = last_place(std::max(std::abs(low_[axis]), std::abs(high_[axis])));
        size[axis] = high_[axis] - low_[axis] + step[axis];
    }
    return kRoundingSteps * (step[0] * size[1] * size[2] + size[0] * step[1] * size[2] +
                             size[0] * size[1] * step[2]) +
           0x1p-1000;  // what underflows
}

std::array<double, 3> CellExtent::middle() const {
    return {low_[0] + (high_[0] - low_[0]) / 2, low_[1] + (high_[1] - low_[1]) / 2,
            low_[2] + (high_[2] - low_[2]) / 2};
}

namespace {

/// Adds the edges of a face as its cell runs along them: lower vertex, higher vertex, and whether
/// the cell runs back from the higher one.
void add_edges(const ComplexView& model, Side side, std::vector<std::uint64_t>& uses) {
    const auto loop = model.face(face_of(side));
    std::int32_t before = loop.back();
    for (const std::int32_t v : loop) {
        const bool back = (v < before) != is_reversed(side);
        const auto high = static_cast<std::uint32_t>(std::max(before, v)) << 1;
        uses.push_back(std::uint64_t{static_cast<std::uint32_t>(std::min(before, v))} << 32 | high |
                       (back ? 1 : 0));
        before = v;
    }
}

}  // namespace

std::optional<EdgeCount> open_edge(const ComplexView& model, std::span<const Side> sides,
                                   std::vector<std::uint64_t>& uses, const Execution& execution) {
    uses.clear();
    if (sides.size() <= kFacesOfLargeCell) {
        for (const Side side : sides)
            add_edges(model, side, uses);
        std::sort(uses.begin(), uses.end());
    } else {
        uses = found_in_ranges<std::uint64_t>(
            sides.size(), kFacesOfLargeCell, execution,
            [&](std::size_t begin, std::size_t end, std::vector<std::uint64_t>& list) {
                for (const Side side : sides.subspan(begin, end - begin))
                    add_edges(model, side, list);
            });
        parallel_sort(uses, std::less<>(), execution);
    }
    for (const auto of_edge : groups_of(uses, [](std::uint64_t use) { return use >> 1; })) {
        const auto back = std::ranges::count_if(of_edge, [](auto use) { return (use & 1) != 0; });
        const auto ahead = std::ssize(of_edge) - back;
        if (ahead == back && (ahead == 1 || model.cell_kind == CellKind::kBlocks)) continue;
        return EdgeCount{static_cast<std::int32_t>(of_edge[0] >> 32),
                         static_cast<std::int32_t>((of_edge[0] >> 1) & INT32_MAX), ahead, back};
    }
    return std::nullopt;
}

}  // namespace realmodel::validation
