// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/equal_pieces.hpp"

#include <algorithm>
#include <bit>

#include "arrangement/region_loops.hpp"
#include "base/parallel.hpp"

namespace realmodel::cutting {

int winding_of(std::span<const NodeId> loop) {
    const std::size_t n = loop.size();
    const auto least = static_cast<std::size_t>(std::ranges::min_element(loop) - loop.begin());
    return loop[(least + 1) % n] < loop[(least + n - 1) % n] ? 1 : -1;
}

void put_first(std::span<const NodeId> loop, std::vector<NodeId>& nodes) {
    const auto least = std::ranges::min_element(loop);
    nodes.assign(least, loop.end());
    nodes.insert(nodes.end(), loop.begin(), least);
    if (winding_of(nodes) < 0) std::reverse(nodes.begin() + 1, nodes.end());
}

std::vector<std::vector<std::size_t>> equal_pieces(const RoundedParts& parts) {
    const CutPieces& pieces = parts.pieces;
    // how many have the same hash, up to 2: only of these the nodes are compared
    std::vector<std::uint8_t> count(std::bit_ceil(8 * pieces.size() + 1), 0);
    constexpr std::size_t kFar = SIZE_MAX;
    Array<std::size_t> slot(pieces.size());
    parallel_ranges(
        pieces.size(), 1 << 12, parts.execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                const auto nodes = pieces.polygons[p];
                const bool is_near = std::ranges::all_of(
                    nodes, [&](NodeId node) { return parts.is_near[index(node)] != 0; });
                slot[p] = is_near ? arrangement::loop_hash(nodes) & (count.size() - 1) : kFar;
            }
        },
        0.05);
    for (const std::size_t own : slot) {
        if (own != kFar) count[own] = static_cast<std::uint8_t>(std::min(count[own] + 1, 2));
    }
    std::vector<std::pair<std::vector<NodeId>, std::size_t>> order;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (slot[p] != kFar && count[slot[p]] > 1)
            put_first(pieces.polygons[p], order.emplace_back(std::vector<NodeId>(), p).first);
    }
    std::ranges::sort(order);
    std::vector<std::vector<std::size_t>> groups;
    for (std::size_t i = 1; i < order.size(); ++i) {
        if (order[i].first != order[i - 1].first) continue;
        if (i == 1 || order[i - 2].first != order[i].first) groups.push_back({order[i - 1].second});
        groups.back().push_back(order[i].second);
    }
    return groups;
}

}  // namespace realmodel::cutting
