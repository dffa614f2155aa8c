// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "base/counting_sort.hpp"

namespace realmodel::strata {

/// The plan vertices that face edges pass between their ends, one edge after another.
struct PassedVertices {
    struct Edge {
        std::uint32_t corner;  ///< that the edge leaves
        std::uint32_t count : 31;
        std::uint32_t is_tentative : 1;  ///< inserted only where something else needs a vertex
    };
    std::vector<Edge> edges;
    std::vector<std::int32_t> vertices;  ///< `count` for each edge, in its direction
};

/// Where the entries of each corner are. Each corner of a face has one, and behind it there is one
/// for each plan vertex that the edge passes which leaves the corner. Few edges pass any, so only
/// these are stored: an offset is found within a short block of corners.
class CornerOffsets {
public:
    CornerOffsets() = default;
    /// @throws InputError kind too_large, where there are more entries than can be numbered
    CornerOffsets(const std::vector<PassedVertices>& passed, std::size_t corners,
                  const Execution& execution);

    /// The first entry of a corner. Of the number of corners: how many entries there are.
    std::uint32_t first(std::size_t corner) const { return entries(corner)[0]; }
    /// The first entry of a corner, and the first of the next one.
    std::array<std::uint32_t, 2> entries(std::size_t corner) const {
        std::uint32_t entry = near(corner);
        const std::size_t block = corner / kBlock;
        const Passing* at = passing_.values.begin() + passing_.offsets[block];
        const Passing* const end = passing_.values.begin() + passing_.offsets[block + 1];
        for (; at != end && at->corner < corner; ++at)
            entry += at->vertices;
        const bool passes = at != end && at->corner == corner;
        return {entry, entry + 1 + (passes ? at->vertices : 0)};
    }
    /// An entry somewhat before those of a corner, of which memory may be asked for.
    std::uint32_t near(std::size_t corner) const {
        return entry_of_block_[corner / kBlock] + static_cast<std::uint32_t>(corner % kBlock);
    }
    /// Calls visit(corner, first entry) for a range of corners.
    template <class Visit>
    void for_each(std::size_t begin, std::size_t end, const Visit& visit) const {
        const Passing* next = passing_.values.begin() + passing_.offsets[begin / kBlock];
        while (next != passing_.values.end() && next->corner < begin)
            ++next;
        std::uint32_t entry = first(begin);
        for (std::size_t corner = begin; corner < end; ++corner) {
            visit(corner, entry++);
            if (next != passing_.values.end() && next->corner == corner)
                entry += (next++)->vertices;
        }
    }
    /// To be called some time before first(): the memory is fetched meanwhile.
    [[gnu::always_inline]] void prefetch(std::size_t corner) const {
        realmodel::prefetch(&entry_of_block_[corner / kBlock]);
        realmodel::prefetch(&passing_.offsets[corner / kBlock]);
    }
    std::size_t corners() const { return corners_; }

private:
    static constexpr std::size_t kBlock = 32;  // corners
    /// An edge that passes plan vertices.
    struct Passing {
        std::uint32_t corner, vertices;
        friend auto operator<=>(const Passing&, const Passing&) = default;
    };

    std::size_t corners_ = 0;
    Array<std::uint32_t> entry_of_block_;  ///< the first of each block
    Buckets<Passing> passing_;             ///< of each block, in order of corners
};

}  // namespace realmodel::strata
