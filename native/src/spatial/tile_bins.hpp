// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// Numbers of things, to be found by the tiles that their boxes meet. What is small is kept once,
/// in the first tile of its box, and looked for as far back as any of that kind reaches; what is
/// larger is kept in every tile.
class TileBins {
public:
    /// span_of(number) is where each of `count` things is, or null where it does not count; what
    /// meets no wanted tile is left out.
    template <class SpanOf>
    TileBins(const PlanTiles& tiles, const std::vector<std::uint8_t>& is_wanted, std::size_t count,
             const SpanOf& span_of, const Execution& execution)
        : tiles_(tiles) {
        struct Part {
            std::int32_t reach = 0;
            std::vector<std::int32_t> larger;
        };
        std::vector<Part> parts((count + kRange - 1) / kRange);
        const auto of_small = [&](std::size_t chunk, const auto& put) {
            Part part;
            for (std::size_t i = chunk * kRange, end = std::min(count, i + kRange); i < end; ++i) {
                const TileSpan* span = span_of(i);
                if (span == nullptr ||
                    !tiles.any(*span, [&](std::size_t tile) { return is_wanted[tile] != 0; }))
                    continue;
                const std::int32_t reach =
                    std::max(span->right - span->left, span->high - span->low);
                if (reach > kSmall) {
                    part.larger.push_back(static_cast<std::int32_t>(i));
                    continue;
                }
                part.reach = std::max(part.reach, reach);
                put(tiles.tile(span->left, span->low), static_cast<std::int32_t>(i));
            }
            parts[chunk] = std::move(part);
        };
        small_ =
            bucketize_in_any_order<std::int32_t>(tiles.size(), parts.size(), of_small, execution);
        std::vector<std::int32_t> larger;
        for (const Part& part : parts) {
            reach_ = std::max(reach_, part.reach);
            larger.insert(larger.end(), part.larger.begin(), part.larger.end());
        }
        if (larger.empty()) return;
        const auto of_larger = [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kRange, end = std::min(larger.size(), i + kRange); i < end;
                 ++i) {
                tiles.for_each(*span_of(index(larger[i])), [&](std::size_t tile) {
                    if (is_wanted[tile] != 0) put(tile, larger[i]);
                });
            }
        };
        larger_ = bucketize_in_any_order<std::int32_t>(
            tiles.size(), (larger.size() + kRange - 1) / kRange, of_larger, execution);
    }

    /// Calls test(number) for the things in these tiles and for some beside them, in no order that
    /// may matter and for some several times, until it is false; whether it never was.
    template <class Test>
    bool all(const TileSpan& span, const Test& test) const {
        const std::int32_t left = std::max(span.left - reach_, 0);
        for (std::int32_t row = std::max(span.low - reach_, 0); row <= span.high; ++row) {
            // the tiles of a row lie side by side
            const std::int32_t* const all = small_.values.data();
            if (!std::all_of(all + small_.offsets[tiles_.tile(left, row)],
                             all + small_.offsets[tiles_.tile(span.right, row) + 1], test))
                return false;
        }
        if (larger_.size() == 0) return true;
        return !tiles_.any(
            span, [&](std::size_t tile) { return !std::ranges::all_of(larger_[tile], test); });
    }

private:
    static constexpr std::size_t kRange = 512;
    static constexpr std::int32_t kSmall = 4;  ///< tiles beyond the first one, at most

    const PlanTiles& tiles_;
    std::int32_t reach_ = 0;  ///< tiles beyond its first one that a small thing is in, at most
    Buckets<std::int32_t> small_, larger_;  ///< of each tile
};

}  // namespace realmodel::spatial
