// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/polygons.hpp"
#include "base/packed_pair.hpp"

namespace realmodel::arrangement {

/// Polygons that tile a face, joined along some of the edges that they share: what is left of
/// their edges are outlines.
class JoinedPolygons {
public:
    struct HalfEdge {
        NodeId from, to;
        std::int32_t polygon, next, twin;
    };

    /// Adds a loop around a polygon, which may have several.
    template <class Loop>
    void add(const Loop& loop, std::int32_t polygon) {
        const auto first = static_cast<std::int32_t>(edges_.size());
        const auto size = static_cast<std::int32_t>(loop.size());
        for (std::int32_t i = 0; i < size; ++i) {
            const std::int32_t next = (i + 1) % size;
            edges_.push_back({loop[index(i)], loop[index(next)], polygon, first + next, -1});
        }
    }

    /// Pairs half-edges that run against each other, in their order, where
    /// may_join(edge, one, other) holds of their nodes (lesser, greater) and polygons.
    template <class MayJoin>
    void pair(const MayJoin& may_join) {
        const auto key = [this](std::int32_t i) {
            const HalfEdge& e = edges_[index(i)];
            return packed_pair(std::min(e.from, e.to), std::max(e.from, e.to));
        };
        auto& order = order_;
        order.clear();
        for (std::int32_t i = 0; index(i) < edges_.size(); ++i)
            order.push_back({key(i), i});
        std::sort(order.begin(), order.end());
        for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
            while (end < order.size() && order[end].first == order[begin].first)
                ++end;
            for (std::size_t i = begin; i < end; ++i) {
                HalfEdge& e = edges_[index(order[i].second)];
                for (std::size_t j = begin; j < end && e.twin < 0; ++j) {
                    HalfEdge& f = edges_[index(order[j].second)];
                    if (f.from != e.to || f.to != e.from || f.twin >= 0 ||
                        !may_join(unpacked_pair(order[i].first), e.polygon, f.polygon))
                        continue;
                    e.twin = order[j].second;
                    f.twin = order[i].second;
                }
            }
        }
    }
    /// Calls visit(one, other) for the polygons of each pair, from both sides.
    template <class Visit>
    void each_pair(const Visit& visit) const {
        for (const HalfEdge& e : edges_) {
            if (e.twin >= 0) visit(e.polygon, edges_[index(e.twin)].polygon);
        }
    }
    /// Parts pairs again unless may_stay(one, other) holds of their polygons.
    template <class MayStay>
    void part(const MayStay& may_stay) {
        for (HalfEdge& e : edges_) {
            if (e.twin < 0 || may_stay(e.polygon, edges_[index(e.twin)].polygon)) continue;
            edges_[index(e.twin)].twin = -1;
            e.twin = -1;
        }
    }
    /// Calls visit(half-edges) for the outlines, in the order of their first half-edges.
    template <class Visit>
    void each_outline(const Visit& visit) {
        done_.assign(edges_.size(), 0);
        for (std::size_t start = 0; start < edges_.size(); ++start) {
            if (done_[start] != 0 || edges_[start].twin >= 0) continue;
            outline_.clear();
            std::size_t e = start;
            do {
                assert(done_[e] == 0 && (outline_.empty() || outline_.back().to == edges_[e].from));
                done_[e] = 1;
                outline_.push_back(edges_[e]);
                e = index(edges_[e].next);
                while (edges_[e].twin >= 0)
                    e = index(edges_[index(edges_[e].twin)].next);
            } while (e != start);
            visit(std::span<const HalfEdge>(outline_));
        }
    }
    /// Takes all polygons away: their memory is kept for others.
    void clear() { edges_.clear(); }

private:
    std::vector<HalfEdge> edges_;
    std::vector<std::pair<std::uint64_t, std::int32_t>> order_;  ///< by the edges' nodes
    std::vector<std::uint8_t> done_;                             ///< of half-edges
    std::vector<HalfEdge> outline_;
};

}  // namespace realmodel::arrangement
