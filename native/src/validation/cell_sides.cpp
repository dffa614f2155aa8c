// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_sides.hpp"

#include "base/parallel.hpp"

namespace realmodel::validation {

namespace {

/// Calls visit(cell, side) for the sides of the cells first .. end, ascending.
template <class Visit>
void for_each_side(const ComplexView& model, std::int32_t first, std::int32_t end,
                   const Progress* progress, const Visit& visit) {
    for (std::size_t i = 0; i < model.face_cells.size(); ++i) {
        if (progress != nullptr && (i & 0x3fff) == 0 && progress->cancelled()) return;
        const std::int32_t cell = model.face_cells[i];
        if (cell >= first && cell < end) visit(static_cast<std::size_t>(cell), i);
    }
}

}  // namespace

// A counting sort. Every thread reads all faces and takes the sides of its own range of cells:
// reading is quick, and nothing is written by two.
CellSides::CellSides(const ComplexView& model, int threads, const Progress* progress)
    : begin_(model.cell_count() + 1, 0) {
    const auto ranges = static_cast<std::size_t>(thread_count(threads));
    const auto bound = [&](std::size_t range) {
        return static_cast<std::int32_t>(model.cell_count() * range / ranges);
    };
    parallel_chunks(ranges, threads, progress, [&](std::size_t range) {
        for_each_side(model, bound(range), bound(range + 1), progress,
                      [&](std::size_t cell, std::size_t) { ++begin_[cell + 1]; });
    });
    for (std::size_t c = 1; c < begin_.size(); ++c)
        begin_[c] += begin_[c - 1];
    sides_.resize(static_cast<std::size_t>(begin_.back()));
    std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
    parallel_chunks(ranges, threads, progress, [&](std::size_t range) {
        for_each_side(model, bound(range), bound(range + 1), progress,
                      [&](std::size_t cell, std::size_t side) {
                          sides_[static_cast<std::size_t>(next[cell]++)] = static_cast<Side>(side);
                      });
    });
}

}  // namespace realmodel::validation
