// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/repair_limits.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/keep_single.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::int32_t kJudgedRing = 6;  ///< a front that has more places there than at first grows
constexpr double kMostOfAll = 0.0005;    ///< that and less of all volumes every block may change by

}  // namespace

RepairLimits::RepairLimits(const ColumnInput& input, std::span<const double> volumes)
    : input_(input),
      volumes_(volumes.begin(), volumes.end()),
      posts_(bucketize<std::size_t>(input.plan.nodes(),
                                    [&](const auto& put) {
                                        for (std::size_t p = 0; p < input.plan.post_count(); ++p)
                                            put(index(input.plan.post_node(p)), p);
                                    })),
      triangles_(bucketize<std::size_t>(input.plan.nodes(),
                                        [&](const auto& put) {
                                            for (std::size_t t = 0; t < input.plan.triangles(); ++t)
                                                for (const std::int32_t n : input.plan.corners(t))
                                                    put(index(n), t);
                                        })),
      is_whole_(volumes.size(), 0) {
    for (const double volume : volumes_)
        least_ += kMostOfAll * volume;
}

/// Calls visit(block) for the blocks that a removal takes volume from, or gives it to.
template <class Visit>
void RepairLimits::for_blocks(const PostLevels& levels, const PostLevels::Removal& removal,
                              const Visit& visit) const {
    for (const std::size_t p : posts_[index(removal.node)]) {
        const std::int32_t rock = input_.heights.rock(p);
        if (rock < 0) continue;
        const auto [below, above] = levels.blocks_at(p, rock, removal.height);
        if (below == above) continue;
        for (const std::int32_t block : {below, above}) {
            if (block >= 0) visit(block);
        }
    }
}

void RepairLimits::limit(const PostLevels& levels,
                         std::vector<PostLevels::Removal>& removals) const {
    std::erase_if(removals, [&](const PostLevels::Removal& removal) {
        bool is_kept = false;
        for_blocks(levels, removal, [&](std::int32_t block) {
            is_kept = is_kept || is_whole_[index(block)] != 0 ||
                      std::binary_search(kept_.begin(), kept_.end(), Place{block, removal.node});
        });
        return is_kept;
    });
}

void RepairLimits::note(const PostLevels& levels, std::span<const PostLevels::Removal> removals) {
    std::vector<Taken> more;
    for (const PostLevels::Removal& removal : removals) {
        for_blocks(levels, removal, [&](std::int32_t block) {
            const Place place{block, removal.node};
            if (found(place) < taken_.size()) return;
            std::int32_t inner = 0;
            for_taken_around(
                place, [&](std::size_t other) { inner = std::max(inner, taken_[other].ring); });
            more.push_back({place, inner + 1});
        });
    }
    taken_.insert(taken_.end(), more.begin(), more.end());
    sort_unique(taken_);
}

/// Where a place stands among those that were taken; their number if it is none.
std::size_t RepairLimits::found(const Place& place) const {
    const auto at = std::lower_bound(taken_.begin(), taken_.end(), Taken{place, 0});
    return at != taken_.end() && at->place == place ? static_cast<std::size_t>(at - taken_.begin())
                                                    : taken_.size();
}

/// Calls visit(which of the taken) for those beside a place.
template <class Visit>
void RepairLimits::for_taken_around(const Place& place, const Visit& visit) const {
    for (const std::size_t t : triangles_[index(place.node)]) {
        for (const std::int32_t node : input_.plan.corners(t)) {
            const std::size_t other = found({place.block, node});
            if (other < taken_.size()) visit(other);
        }
    }
}

bool RepairLimits::changes_much(std::size_t block, std::span<const double> volumes,
                                double most) const {
    return std::abs(volumes[block] - volumes_[block]) > std::max(most * volumes_[block], least_);
}

/// The places that were taken in one piece.
std::vector<std::vector<std::size_t>> RepairLimits::fronts() const {
    std::vector<std::vector<std::size_t>> made;
    std::vector<std::uint8_t> is_seen(taken_.size(), 0);
    for (std::size_t start = 0; start < taken_.size(); ++start) {
        if (is_seen[start] != 0) continue;
        is_seen[start] = 1;
        std::vector<std::size_t> front{start};
        for (std::size_t k = 0; k < front.size(); ++k) {
            for_taken_around(taken_[front[k]].place, [&](std::size_t other) {
                if (is_seen[other] != 0) return;
                is_seen[other] = 1;
                front.push_back(other);
            });
        }
        made.push_back(std::move(front));
    }
    return made;
}

bool RepairLimits::take_back(std::span<const double> volumes, double most) {
    std::vector<std::uint8_t> is_much(volumes.size(), 0);
    for (std::size_t b = 0; b < volumes.size(); ++b)
        is_much[b] = is_whole_[b] == 0 && changes_much(b, volumes, most) ? 1 : 0;
    std::vector<std::uint8_t> is_answered(volumes.size(), 0);
    bool any = false;
    for (const std::vector<std::size_t>& front : fronts()) {
        const auto in_ring = [&](std::int32_t ring) {
            return std::count_if(front.begin(), front.end(),
                                 [&](std::size_t at) { return taken_[at].ring == ring; });
        };
        const std::size_t block = index(taken_[front[0]].place.block);
        if (in_ring(kJudgedRing) <= in_ring(1) && (is_much[block] == 0 || in_ring(2) == 0))
            continue;
        for (const std::size_t at : front)
            kept_.push_back(taken_[at].place);
        any = true;
        is_answered[block] = 1;
    }
    sort_unique(kept_);
    for (std::size_t b = 0; b < volumes.size(); ++b) {
        if (is_much[b] == 0 || is_answered[b] != 0) continue;
        is_whole_[b] = 1;
        any = true;
    }
    taken_.clear();
    return any;
}

std::vector<std::int32_t> RepairLimits::kept_blocks() const {
    std::vector<std::int32_t> made;
    for (const Place& place : kept_)
        made.push_back(place.block);
    for (std::size_t b = 0; b < is_whole_.size(); ++b) {
        if (is_whole_[b] != 0) made.push_back(static_cast<std::int32_t>(b));
    }
    sort_unique(made);
    return made;
}

}  // namespace realmodel::simulation
