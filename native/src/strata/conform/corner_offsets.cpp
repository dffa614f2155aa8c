// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/corner_offsets.hpp"

#include <algorithm>
#include <cassert>

namespace realmodel::strata {

CornerOffsets::CornerOffsets(const std::vector<PassedVertices>& passed, std::size_t corners,
                             const Execution& execution)
    : corners_(corners) {
    const std::size_t blocks = corners / kBlock + 1;  // the number of corners itself has one, too
    passing_of_block_ = zeros<std::uint32_t>(blocks + 1, execution);
    std::vector<std::vector<std::uint32_t>> number(passed.size());  // of each edge in its block
    parallel_chunks(passed.size(), execution, [&](std::size_t chunk) {
        for (const PassedVertices::Edge& edge : passed[chunk].edges) {
            assert(edge.corner < corners);
            number[chunk].push_back(count_one(passing_of_block_[edge.corner / kBlock]));
        }
    });
    running_totals(passing_of_block_, UINT32_MAX, execution);
    passing_ = Array<Passing>(passing_of_block_[blocks]);
    parallel_chunks(passed.size(), execution, [&](std::size_t chunk) {
        auto next = number[chunk].begin();
        for (const PassedVertices::Edge& edge : passed[chunk].edges) {
            const std::uint32_t first = passing_of_block_[edge.corner / kBlock];
            passing_[first + *next++] = {edge.corner, edge.count};
        }
    });
    entry_of_block_ = Array<std::uint32_t>(blocks + 1);
    parallel_each(blocks, execution, [&](std::size_t block) {
        const auto first = passing_.begin() + passing_of_block_[block];
        const auto last = passing_.begin() + passing_of_block_[block + 1];
        std::sort(first, last,
                  [](const Passing& a, const Passing& b) { return a.corner < b.corner; });
        std::size_t entries = std::min(kBlock, corners - block * kBlock);
        for (auto passing = first; passing != last; ++passing)
            entries += passing->vertices;
        entry_of_block_[block] = static_cast<std::uint32_t>(entries);
    });
    running_totals(entry_of_block_, UINT32_MAX, execution);
}

}  // namespace realmodel::strata
