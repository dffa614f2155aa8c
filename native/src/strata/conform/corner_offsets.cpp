// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/corner_offsets.hpp"

#include <algorithm>

namespace realmodel::strata {

CornerOffsets::CornerOffsets(const std::vector<PassedVertices>& passed, std::size_t corners,
                             const Execution& execution)
    : corners_(corners) {
    const std::size_t blocks = corners / kBlock + 1;  // the number of corners itself has one, too
    const auto produce = [&](std::size_t chunk, const auto& put) {
        for (const PassedVertices::Edge& edge : passed[chunk].edges)
            put(edge.corner / kBlock, Passing{edge.corner, edge.count});
    };
    passing_ = sorted_in_buckets<Passing>(blocks, passed.size(), produce, execution);
    entry_of_block_ = Array<std::uint32_t>(blocks + 1);
    parallel_each(blocks, execution, [&](std::size_t block) {
        std::size_t entries = std::min(kBlock, corners - block * kBlock);
        for (const Passing& passing : passing_[block])
            entries += passing.vertices;
        entry_of_block_[block] = static_cast<std::uint32_t>(entries);
    });
    running_totals(entry_of_block_, UINT32_MAX, execution);
}

}  // namespace realmodel::strata
