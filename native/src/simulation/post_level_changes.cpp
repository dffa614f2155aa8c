// SPDX-License-Identifier: GPL-3.0-or-later
// How the repairs of columns change levels.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/index.hpp"
#include "simulation/post_levels.hpp"

namespace realmodel::simulation {

std::array<std::int32_t, 2> PostLevels::blocks_at(std::size_t post, std::int32_t rock,
                                                  std::int32_t height) const {
    const auto own = levels(post);
    const auto blocks = layer_blocks(rock);
    std::int32_t below = -1, above = -1;
    for (std::size_t l = 0; l + 1 < own.size(); ++l) {
        if (own[l] == own[l + 1]) continue;
        if (own[l + 1] == height) below = blocks[l];
        if (own[l] == height) above = blocks[l];
    }
    return {below, above};
}

std::size_t PostLevels::remove(const PlanTopology& plan, std::vector<Removal>& removals,
                               bool several) {
    std::sort(removals.begin(), removals.end());
    constexpr std::int32_t kKept = -1;
    std::vector<std::int32_t> into(height_.size(), kKept);
    std::vector<std::uint8_t> is_used(height_.size(), 0);
    std::size_t count = 0;
    std::int32_t last = -1;
    for (const Removal& removal : removals) {
        if (!several && removal.node == last) continue;
        assert(std::abs(removal.height - removal.into) == 1);
        const std::size_t first = node_offset_[index(removal.node)],
                          gone = first + index(removal.height), kept = first + index(removal.into);
        if (is_used[gone] != 0 || is_used[kept] != 0) continue;
        is_used[gone] = is_used[kept] = 1;
        into[gone] = removal.into;
        last = removal.node;
        ++count;
    }
    // the new numbers of heights among those of their node
    std::vector<std::int32_t> number(height_.size());
    std::size_t to = 0;
    std::vector<std::size_t> offset{0};
    offset.reserve(node_offset_.size());
    for (std::size_t n = 0; n + 1 < node_offset_.size(); ++n) {
        const std::size_t begin = node_offset_[n], end = node_offset_[n + 1];
        for (std::size_t h = begin; h < end; ++h) {
            if (into[h] != kKept) continue;
            number[h] = static_cast<std::int32_t>(to - offset[n]);
            first_height_[to] = first_height_[h];
            height_[to++] = height_[h];
        }
        for (std::size_t h = begin; h < end; ++h) {
            if (into[h] != kKept) number[h] = number[begin + index(into[h])];
        }
        offset.push_back(to);
    }
    for (std::size_t p = 0; p + 1 < offset_.size(); ++p) {
        const std::size_t begin = node_offset_[index(plan.post_node(p))];
        for (std::size_t l = offset_[p]; l < offset_[p + 1]; ++l)
            level_[l] = number[begin + index(level_[l])];
    }
    node_offset_ = std::move(offset);
    height_.resize(to);
    first_height_.resize(to);
    assert(is_valid(plan));
    return count;
}

bool PostLevels::ease(const std::vector<Move>& moves, double most, double gap, bool alone,
                      std::span<const std::uint8_t> has_flat_base,
                      std::span<std::uint8_t> is_moved) {
    constexpr double kLeast = 1e-3;  // of `most`: what is worth another round
    struct Asked {
        double by = 0;
        std::int32_t count = 0, lowest = INT32_MAX;
    };
    std::vector<Asked> asked(alone ? height_.size() : node_offset_.size() - 1);
    for (const Move& move : moves) {
        const auto n = index(move.node);
        Asked& own = asked[alone ? node_offset_[n] + index(move.height) : n];
        own.by += move.by;
        ++own.count;
        own.lowest = std::min(own.lowest, move.height);
    }
    bool any = false;
    for (std::size_t n = 0; n + 1 < node_offset_.size(); ++n) {
        const std::size_t first = node_offset_[n], end = node_offset_[n + 1];
        const auto move = [&](std::size_t at, double by) {
            const double own = height_[at];
            if (has_flat_base[n] != 0 && at == first) return;
            double to = std::clamp(own + by, first_height_[at] - most, first_height_[at] + most);
            if (at > first) to = std::max(to, std::min(own, height_[at - 1] + gap));
            if (at + 1 < end) to = std::min(to, std::max(own, height_[at + 1] - gap));
            if (std::abs(to - own) < kLeast * gap) return;
            height_[at] = to;
            is_moved[n] = 1;
            any = true;
        };
        if (alone) {
            for (std::size_t at = first; at < end; ++at) {
                if (asked[at].count > 0) move(at, asked[at].by / asked[at].count);
            }
            continue;
        }
        if (asked[n].count == 0) continue;
        const double by = asked[n].by / asked[n].count, bottom = height_[first],
                     span = height_[first + index(asked[n].lowest)] - bottom;
        const auto share = [&](std::size_t at) {
            return has_flat_base[n] == 0 ? 1 : std::min(1.0, (height_[at] - bottom) / span);
        };
        // what moves first makes room for the next
        if (by < 0) {
            for (std::size_t at = first; at < end; ++at)
                move(at, share(at) * by);
        } else {
            for (std::size_t at = end; at-- > first;)
                move(at, share(at) * by);
        }
        assert(std::is_sorted(&height_[first], &height_[first] + (end - first)));
    }
    return any;
}

}  // namespace realmodel::simulation
