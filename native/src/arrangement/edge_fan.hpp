// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/polygons.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "exact/space_points.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel::arrangement {

/// A polygon seen along one of its edges.
struct EdgeUse {
    std::array<NodeId, 2> edge;  ///< lesser, greater
    std::int32_t item;           ///< region, or face after all regions
    std::int8_t direction;       ///< 1 from lesser to greater, -1 back
    /// By edges, then items and directions; in whole words, as most of the sorting is comparing.
    bool operator<(const EdgeUse& other) const {
        const auto key = [](const EdgeUse& use) {
            return std::array{use.key(), packed_pair(use.item, use.direction + 1)};
        };
        const auto a = key(*this), b = key(other);
        return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1];
    }
    /// Of the edge: as many keys as edges, in the same order.
    std::uint64_t key() const { return packed_pair(edge[0], edge[1]); }

    /// The side of the item that is ahead of it for one who goes round the edge, 0 or 1; the other
    /// one is behind it. Side 0 is the one that the item does not turn counter-clockwise for.
    std::size_t ahead() const { return direction > 0 ? 0 : 1; }
    std::size_t behind() const { return 1 - ahead(); }
};

/// Edges in order, and all uses of each.
struct EdgeUses {
    Array<EdgeUse> uses;
    Array<std::size_t> begins{0};  ///< of each edge in `uses`, and the end of the last

    std::size_t size() const { return begins.size() - 1; }
    std::span<const EdgeUse> operator[](std::size_t edge) const {
        return {uses.data() + begins[edge], begins[edge + 1] - begins[edge]};
    }
    const std::array<NodeId, 2>& ends(std::size_t edge) const { return uses[begins[edge]].edge; }
    /// The uses of the edge between two nodes (lesser, greater).
    std::span<const EdgeUse> between(const std::array<NodeId, 2>& edge) const {
        const std::span<const EdgeUse> all(uses.data(), uses.size());
        const auto first = std::ranges::lower_bound(all, edge, {}, &EdgeUse::edge);
        return {first, std::ranges::upper_bound(all, edge, {}, &EdgeUse::edge)};
    }
};

/// Calls visit(use) for all edges of some loops.
template <class Loops, class Visit>
void for_each_edge(const Loops& loops, std::int32_t item, const Visit& visit) {
    for (const auto& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const NodeId a = loop[i], b = loop[i + 1 < loop.size() ? i + 1 : 0];
            assert(a != b);
            visit(EdgeUse{unordered(a, b), item, static_cast<std::int8_t>(a < b ? 1 : -1)});
        }
    }
}

/// The edges of some polygons, which are numbered from 0 on as items.
/// @param nodes    how many there are
/// @param loop_of  loop_of(item): its nodes
/// @throws InputError kind too_large, Cancelled
template <class LoopOf>
EdgeUses edges_of(std::size_t items, std::size_t nodes, const LoopOf& loop_of,
                  const Execution& execution) {
    constexpr std::size_t kChunk = 1 << 12;
    auto sorted = sorted_in_buckets<EdgeUse>(
        nodes, (items + kChunk - 1) / kChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kChunk; i < std::min(items, (chunk + 1) * kChunk); ++i) {
                for_each_edge(std::array{std::span<const NodeId>(loop_of(i))},
                              static_cast<std::int32_t>(i),
                              [&](const EdgeUse& use) { put(index(use.edge[0]), use); });
            }
        },
        execution);
    EdgeUses edges{std::move(sorted.values)};
    number_in_order(
        edges.uses.size(), execution,
        [&](std::size_t i) { return i == 0 || edges.uses[i].key() != edges.uses[i - 1].key(); },
        [&](std::size_t count) {
            checked_number(count, "edges");
            edges.begins.resize(count + 1);
            edges.begins[count] = edges.uses.size();
        },
        [&](std::size_t i, std::size_t edge) { edges.begins[edge] = i; });
    return edges;
}

/// Half of a plane that begins at an edge.
struct HalfPlane {
    exact::SpacePointId towards;  ///< a point of it, not on the line of the edge
    std::int32_t plane;           ///< two of the same number, if it is not -1, lie in one plane
    std::int8_t direction;        ///< 1 or -1: two of the same plane and direction are the same
};

/// Half-planes around one edge in counter-clockwise order for one who looks along it, beginning
/// with the first. Those that are the same are one, with several items.
struct EdgeFan {
    std::vector<std::size_t> order;                 ///< numbers of half-planes
    std::vector<std::size_t> half_plane_begins{0};  ///< in `order`, and its end

    std::size_t half_planes() const { return half_plane_begins.size() - 1; }
    std::span<const std::size_t> half_plane(std::size_t i) const {
        return {order.data() + half_plane_begins[i],
                half_plane_begins[i + 1] - half_plane_begins[i]};
    }
};

/// The fan around the edge from a to b, in one that was another before, whose memory it takes.
void find_fan(const exact::SpacePoints& points, exact::SpacePointId a, exact::SpacePointId b,
              std::span<const HalfPlane> items, EdgeFan& fan);

}  // namespace realmodel::arrangement
