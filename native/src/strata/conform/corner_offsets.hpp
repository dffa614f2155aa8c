// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/parallel_counts.hpp"

namespace realmodel::strata {

/// The places that face edges pass between their ends, one edge after another: the corner that it
/// leaves, how many there are, and they themselves in its order. Where a count is negative, they
/// are taken up only if something else needs a vertex there.
using PassedVertices = std::vector<std::int32_t>;

/// Which entries of the loops are whose. Each corner of a face has one, and behind it there is one
/// for each place that the edge passes which leaves the corner. Few edges pass any, so only these
/// are kept: a number is found within a short block of corners.
class CornerOffsets {
public:
    CornerOffsets() = default;
    /// @throws InputError kind too_large, where there are more entries than can be numbered
    CornerOffsets(const std::vector<PassedVertices>& passed, std::size_t corners, int threads,
                  const Progress* progress);

    /// The first entry of a corner. Of the number of corners: how many entries there are.
    std::uint32_t first(std::size_t corner) const {
        const std::size_t block = corner / kBlock;
        std::uint32_t entry = entry_of_block_[block] + static_cast<std::uint32_t>(corner % kBlock);
        const std::uint32_t end = passing_of_block_[block + 1];
        for (std::uint32_t i = passing_of_block_[block]; i < end && passing_[i].corner < corner;
             ++i)
            entry += passing_[i].places;
        return entry;
    }
    /// Calls visit(corner, first entry) for a range of corners.
    template <class Visit>
    void for_each(std::size_t begin, std::size_t end, const Visit& visit) const {
        std::uint32_t next = passing_of_block_[begin / kBlock];
        while (next < passing_.size() && passing_[next].corner < begin)
            ++next;
        std::uint32_t entry = first(begin);
        for (std::size_t corner = begin; corner < end; ++corner) {
            visit(corner, entry++);
            if (next < passing_.size() && passing_[next].corner == corner)
                entry += passing_[next++].places;
        }
    }
    /// To be called some time before first(), as memory takes its time.
    [[gnu::always_inline]] void prefetch(std::size_t corner) const {
        realmodel::prefetch(&entry_of_block_[corner / kBlock]);
        realmodel::prefetch(&passing_of_block_[corner / kBlock]);
    }
    std::size_t corners() const { return corners_; }

private:
    static constexpr std::size_t kBlock = 32;  // corners
    /// An edge that passes places.
    struct Passing {
        std::uint32_t corner, places;
    };

    std::size_t corners_ = 0;
    FlatArray<std::uint32_t> entry_of_block_, passing_of_block_;  ///< the first of each block
    FlatArray<Passing> passing_;                                  ///< in order of corners
};

}  // namespace realmodel::strata
