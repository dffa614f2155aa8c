// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/parallel_counts.hpp"
#include "strata/plan_tiles.hpp"

namespace realmodel::strata {

/// Numbers of things, to be found by the tiles that their boxes meet. What is small is kept once,
/// in the first tile of its box, and looked for as far back as any of that kind reaches; what is
/// larger is kept in every tile.
class TileBins {
public:
    /// span_of(number) is where each of `count` things is, or null where it does not count; what
    /// meets no wanted tile is left out.
    template <class SpanOf>
    TileBins(const PlanTiles& tiles, const std::vector<std::uint8_t>& is_wanted, std::size_t count,
             const SpanOf& span_of, int threads, const Progress* progress)
        : tiles_(tiles), first_(zeros<std::uint32_t>(tiles.size() + 1, threads, progress)) {
        struct Range {
            std::int32_t reach = 0;
            std::vector<std::int32_t> larger;
        };
        std::vector<Range> ranges((count + kRange - 1) / kRange);
        FlatArray<std::uint32_t> within(count);  // its tile, where it is small; else kNotHere
        parallel_ranges(count, kRange, threads, progress, [&](std::size_t begin, std::size_t end) {
            Range& range = ranges[begin / kRange];
            for (std::size_t i = begin; i < end; ++i) {
                within[i] = kNotHere;
                const TileSpan* span = span_of(i);
                if (span == nullptr ||
                    !tiles.any(*span, [&](std::size_t tile) { return is_wanted[tile] != 0; }))
                    continue;
                const std::int32_t reach =
                    std::max(span->right - span->left, span->high - span->low);
                if (reach > kSmall) {
                    range.larger.push_back(static_cast<std::int32_t>(i));
                    continue;
                }
                range.reach = std::max(range.reach, reach);
                within[i] = count_one(first_[tiles.tile(span->left, span->low)]);
            }
        });
        running_totals(first_, UINT32_MAX, threads, progress);
        small_ = FlatArray<std::int32_t>(first_[tiles.size()]);
        parallel_ranges(count, kRange, threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (within[i] == kNotHere) continue;
                const TileSpan* span = span_of(i);
                small_[first_[tiles.tile(span->left, span->low)] + within[i]] =
                    static_cast<std::int32_t>(i);
            }
        });
        std::vector<std::int32_t> larger;
        for (const Range& range : ranges) {
            reach_ = std::max(reach_, range.reach);
            larger.insert(larger.end(), range.larger.begin(), range.larger.end());
        }
        if (!larger.empty()) add_larger(larger, is_wanted, span_of, threads, progress);
    }

    /// Calls test(number) for the things in these tiles and for some beside them, in no order that
    /// may matter and for some several times, until it is false; whether it never was.
    template <class Test>
    bool all(const TileSpan& span, const Test& test) const {
        const std::int32_t left = std::max(span.left - reach_, 0);
        for (std::int32_t row = std::max(span.low - reach_, 0); row <= span.high; ++row) {
            // the tiles of a row lie side by side
            const std::int32_t* const begin = small_.begin() + first_[tiles_.tile(left, row)];
            const std::int32_t* const end =
                small_.begin() + first_[tiles_.tile(span.right, row) + 1];
            if (!std::all_of(begin, end, test)) return false;
        }
        if (larger_.size() == 0) return true;
        return !tiles_.any(span, [&](std::size_t tile) {
            return !std::all_of(larger_.begin() + of_larger_[tile],
                                larger_.begin() + of_larger_[tile + 1], test);
        });
    }

private:
    static constexpr std::size_t kRange = 512;
    static constexpr std::int32_t kSmall = 4;  ///< tiles beyond the first one, at most
    static constexpr std::uint32_t kNotHere = UINT32_MAX;

    template <class SpanOf>
    void add_larger(const std::vector<std::int32_t>& larger,
                    const std::vector<std::uint8_t>& is_wanted, const SpanOf& span_of, int threads,
                    const Progress* progress) {
        // Calls visit(tile, number), from several threads.
        const auto for_all = [&](const auto& visit) {
            parallel_ranges(larger.size(), kRange, threads, progress,
                            [&](std::size_t begin, std::size_t end) {
                                for (std::size_t i = begin; i < end; ++i) {
                                    const std::int32_t number = larger[i];
                                    tiles_.for_each(*span_of(static_cast<std::size_t>(number)),
                                                    [&](std::size_t tile) {
                                                        if (is_wanted[tile] != 0)
                                                            visit(tile, number);
                                                    });
                                }
                            });
        };
        of_larger_ = zeros<std::uint32_t>(tiles_.size() + 1, threads, progress);
        for_all([&](std::size_t tile, std::int32_t) { count_one(of_larger_[tile]); });
        running_totals(of_larger_, UINT32_MAX, threads, progress);
        larger_ = FlatArray<std::int32_t>(of_larger_[tiles_.size()]);
        auto filled = zeros<std::uint32_t>(tiles_.size(), threads, progress);
        for_all([&](std::size_t tile, std::int32_t number) {
            larger_[of_larger_[tile] + count_one(filled[tile])] = number;
        });
    }

    const PlanTiles& tiles_;
    std::int32_t reach_ = 0;  ///< tiles beyond its first one that a small thing is in, at most
    FlatArray<std::uint32_t> first_, of_larger_;  ///< before each tile
    FlatArray<std::int32_t> small_, larger_;
};

}  // namespace realmodel::strata
