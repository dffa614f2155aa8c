// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/sparse_rows.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace realmodel::interpolation {

/// The row of a node from its hinges, by columns.
void SparseRows::find_row(std::size_t row, std::span<const Hinge> hinges, const HingesOfNodes& of,
                          std::vector<Entry>& entries) {
    entries.assign(1, {static_cast<std::int32_t>(row), 0.0});
    for (const std::int32_t number : of[row]) {
        const Hinge& h = hinges[number];
        int mine = 0;
        while (h.nodes[mine] != static_cast<std::int32_t>(row))
            ++mine;
        for (int other = 0; other < 4; ++other) {
            const double value = h.g[mine] * h.g[other];
            const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) {
                return e.column == h.nodes[other];
            });
            if (found == entries.end()) {
                entries.push_back({h.nodes[other], value});
            } else {
                found->value += value;
            }
        }
    }
    std::ranges::sort(entries, {}, &Entry::column);
}

SparseRows::SparseRows(std::size_t nodes, std::span<const Hinge> hinges, int threads)
    : size_(nodes),
      first_((nodes + kSideBySide - 1) / kSideBySide + 1, 0),
      diagonal_(nodes),
      rough_diagonal_(nodes) {
    const auto of = bucketize<std::int32_t>(nodes, [&](const auto& visit) {
        for (std::size_t h = 0; h < hinges.size(); ++h) {
            for (const std::int32_t v : hinges[h].nodes)
                visit(v, static_cast<std::int32_t>(h));
        }
    });
    const std::size_t slices = first_.size() - 1;
    in_pieces(slices, threads, [&](std::size_t from, std::size_t to) {
        std::vector<Entry> entries;
        for (std::size_t slice = from; slice < to; ++slice) {
            std::size_t longest = 0;
            const std::size_t end = std::min(kSideBySide * (slice + 1), nodes);
            for (std::size_t row = kSideBySide * slice; row < end; ++row) {
                find_row(row, hinges, of, entries);
                longest = std::max(longest, entries.size());
            }
            first_[slice + 1] = kSideBySide * longest;
        }
    });
    for (std::size_t slice = 0; slice < slices; ++slice)
        first_[slice + 1] += first_[slice];
    column_.resize(first_.back());
    value_.resize(first_.back());
    in_pieces(slices, threads, [&](std::size_t from, std::size_t to) {
        std::vector<Entry> entries;
        for (std::size_t slice = from; slice < to; ++slice)
            fill_slice(slice, hinges, of, entries);
    });
    make_sweep();
}

/// Rows that are shorter than the longest of the slice, or beyond the last, end with zeros.
void SparseRows::fill_slice(std::size_t slice, std::span<const Hinge> hinges,
                            const HingesOfNodes& of, std::vector<Entry>& entries) {
    for (std::size_t side = 0; side < kSideBySide; ++side) {
        const std::size_t row = kSideBySide * slice + side;
        const auto padding = static_cast<std::int32_t>(std::min(row, size_ - 1));
        std::size_t k = first_[slice] + side;
        entries.clear();
        if (row < size_) find_row(row, hinges, of, entries);
        for (const Entry& e : entries) {
            if (e.column == padding) {
                diagonal_[row] = k;
                rough_diagonal_[row] = e.value;
            }
            column_[k] = e.column;
            value_[k] = e.value;
            k += kSideBySide;
        }
        for (; k < first_[slice + 1]; k += kSideBySide)
            column_[k] = padding;
    }
}

void SparseRows::make_sweep() {
    std::vector<StagedSweep::Reach> reach;
    for (std::size_t begin = 0; begin < size(); begin += kMostRows) {
        const auto from =
            column_.begin() + static_cast<std::ptrdiff_t>(first_[begin / kSideBySide]);
        const std::size_t end = std::min(begin + kMostRows, size());
        const auto to = column_.begin() +
                        static_cast<std::ptrdiff_t>(first_[(end + kSideBySide - 1) / kSideBySide]);
        const auto [low, high] = std::minmax_element(from, to);
        reach.emplace_back(static_cast<std::size_t>(*low) / kMostRows,
                           static_cast<std::size_t>(*high) / kMostRows);
    }
    sweep_ = StagedSweep(std::move(reach));
}

void SparseRows::add(std::int32_t row, std::int32_t column, double value) {
    std::size_t entry = first_[row / kSideBySide] + row % kSideBySide;
    while (column_[entry] != column) {
        entry += kSideBySide;
        assert(entry < first_[row / kSideBySide + 1]);
    }
    changed_.push_back({entry, value_[entry]});
    value_[entry] += value;
}

void SparseRows::remove_added() {
    while (!changed_.empty()) {
        value_[changed_.back().entry] = changed_.back().before;
        changed_.pop_back();
    }
}

double SparseRows::magnitude(std::size_t row) const {
    double sum = 0;
    for_entries(row, [&](std::int32_t, double value) { sum += std::abs(value); });
    return sum;
}

}  // namespace realmodel::interpolation
