// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "base/key_table.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/array.hpp"

namespace realmodel::arrangement {

using Position = Vec3;
using PlanePosition = Vec2;
using NodeId = std::int32_t;

/// How far a cross product of two steps may be off where each corner is by `rounding`.
inline double slack(const PlanePosition& a, const PlanePosition& b, const PlanePosition& c,
                    const PlanePosition& rounding) {
    return rounding[0] * (std::abs(b[1] - a[1]) + std::abs(c[1] - b[1])) +
           rounding[1] * (std::abs(b[0] - a[0]) + std::abs(c[0] - b[0]));
}

/// Whether a node is there twice.
/// @param node_of  node_of(element): its node
template <class Nodes, class NodeOf = std::identity>
bool has_repeated(const Nodes& nodes, const NodeOf& node_of = {}) {
    constexpr std::size_t kFew = 16;
    const auto begin = nodes.begin(), end = nodes.end();
    if (nodes.size() <= kFew) {
        for (auto at = begin; at != end; ++at) {
            if (std::ranges::find(begin, at, std::invoke(node_of, *at), node_of) != at) return true;
        }
        return false;
    }
    std::vector<NodeId> sorted(nodes.size());
    std::ranges::transform(nodes, sorted.begin(), node_of);
    std::ranges::sort(sorted);
    return std::ranges::adjacent_find(sorted) != sorted.end();
}

/// Many polygons in one array.
struct Polygons {
    std::vector<std::int64_t> offsets{0};
    std::vector<NodeId> nodes;

    std::size_t size() const { return offsets.size() - 1; }
    std::span<const NodeId> operator[](std::size_t i) const {
        return {nodes.data() + offsets[i], static_cast<std::size_t>(offsets[i + 1] - offsets[i])};
    }
    void add(std::span<const NodeId> polygon) {
        for (const NodeId node : polygon)  // which are few
            nodes.push_back(node);
        close();
    }
    /// Some of others, from one up to another.
    void add(const Polygons& others, std::size_t begin, std::size_t end) {
        const auto moved = static_cast<std::int64_t>(nodes.size()) - others.offsets[begin];
        nodes.insert(nodes.end(), others.nodes.begin() + others.offsets[begin],
                     others.nodes.begin() + others.offsets[end]);
        for (std::size_t i = begin; i < end; ++i)
            offsets.push_back(others.offsets[i + 1] + moved);
    }
    /// Ends a polygon whose nodes were appended one by one.
    void close() { offsets.push_back(static_cast<std::int64_t>(nodes.size())); }
    void clear() {
        offsets.resize(1);
        nodes.clear();
    }
};

/// A view of space along its coordinate axis that is nearest to a normal: polygons that turn
/// counter-clockwise about the normal do so in the view.
class View {
public:
    explicit View(const Position& normal);
    PlanePosition operator()(const Position& p) const { return {p[u_], p[v_]}; }
    /// How far apart on either axis rounding may put things that coincide: a few units in
    /// the last place of the largest coordinates.
    PlanePosition rounding(std::span<const Position> positions) const;
    /// The axis, and 1 where the view is from its positive end, -1 from its negative.
    std::size_t axis() const { return 3 - u_ - v_; }
    int sign() const { return v_ == (axis() + 2) % 3 ? 1 : -1; }

private:
    std::size_t u_, v_;
};

/// How far apart rounding may put things that coincide: a few units in the last place of
/// the largest coordinate.
double rounding_of(std::span<const Position> positions);

/// The outline of a region, then its holes: views of what a LoopTable has.
template <class Node>
class Loops {
public:
    class Iterator {
    public:
        using iterator_category = std::forward_iterator_tag;
        using difference_type = std::ptrdiff_t;
        using value_type = std::span<const Node>;
        using reference = value_type;
        using pointer = void;

        Iterator() = default;
        Iterator(const Node* nodes, const std::size_t* begin) : nodes_(nodes), begin_(begin) {}
        value_type operator*() const { return {nodes_ + begin_[0], nodes_ + begin_[1]}; }
        Iterator& operator++() {
            ++begin_;
            return *this;
        }
        Iterator operator++(int) {
            Iterator before = *this;
            ++begin_;
            return before;
        }
        bool operator==(const Iterator&) const = default;

    private:
        const Node* nodes_ = nullptr;
        const std::size_t* begin_ = nullptr;
    };

    Loops(const Node* nodes, const std::size_t* begins, std::size_t count)
        : nodes_(nodes), begins_(begins), count_(count) {}
    std::size_t size() const { return count_; }
    std::span<const Node> operator[](std::size_t i) const { return *Iterator(nodes_, begins_ + i); }
    Iterator begin() const { return {nodes_, begins_}; }
    Iterator end() const { return {nodes_, begins_ + count_}; }

private:
    const Node* nodes_;
    const std::size_t* begins_;
    std::size_t count_;
};

/// A hash that is the same for loops of the same nodes, wherever they begin.
template <class Node>
std::uint32_t loop_hash(std::span<const Node> loop) {
    std::uint32_t hash = 0;
    for (const Node node : loop)
        hash += KeyTable::hash(std::array{static_cast<std::uint64_t>(index(node))});
    return hash;
}

/// 1 where two loops pass the same nodes in the same order, from whichever on; -1 where they do so
/// against each other; else 0.
template <class Node>
std::int8_t facing_of(std::span<const Node> one, std::span<const Node> other) {
    const std::size_t n = one.size();
    if (other.size() != n) return 0;
    for (const bool back : {false, true}) {
        for (std::size_t begin = 0; begin < n; ++begin) {
            std::size_t i = 0;
            while (i < n && one[i] == other[(begin + (back ? n - i : i)) % n])
                ++i;
            if (i == n) return back ? -1 : 1;
        }
    }
    return 0;
}

/// The loops of many regions in three arrays.
template <class Node>
struct LoopTable {
    Array<Node> nodes;
    Array<std::size_t> loop_begins{0};    ///< in `nodes`, and the end of the last
    Array<std::size_t> region_begins{0};  ///< among loops, likewise

    std::size_t size() const { return region_begins.size() - 1; }
    Loops<Node> operator[](std::size_t region) const {
        const std::size_t begin = region_begins[region];
        return {nodes.data(), loop_begins.data() + begin, region_begins[region + 1] - begin};
    }
    void add_loop(std::span<const Node> loop) {
        nodes.append(loop.begin(), loop.end());
        end_loop();
    }
    /// Ends a loop whose nodes were appended one by one.
    void end_loop() { loop_begins.push_back(nodes.size()); }
    /// Ends a region whose loops were added.
    void end_region() { region_begins.push_back(loop_begins.size() - 1); }
};

/// Polygons that tile a face, joined along some of the edges that they share: what is left of
/// their edges are outlines.
class JoinedPolygons {
public:
    struct PolygonHalfEdge {
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
            const PolygonHalfEdge& e = edges_[index(i)];
            return packed_pair(std::min(e.from, e.to), std::max(e.from, e.to));
        };
        auto& order = order_;
        order.clear();
        for (std::int32_t i = 0; index(i) < edges_.size(); ++i)
            order.push_back({key(i), i});
        std::sort(order.begin(), order.end());
        for (const auto on_edge : groups_of(order, &KeyedEdge::first)) {
            for (const auto& [edge, one] : on_edge) {
                PolygonHalfEdge& e = edges_[index(one)];
                for (const auto& [same_edge, other] : on_edge) {
                    if (e.twin >= 0) break;
                    PolygonHalfEdge& f = edges_[index(other)];
                    if (f.from != e.to || f.to != e.from || f.twin >= 0 ||
                        !may_join(unpacked_pair(edge), e.polygon, f.polygon))
                        continue;
                    e.twin = other;
                    f.twin = one;
                }
            }
        }
    }
    /// Calls visit(one, other) for the polygons of each pair, from both sides.
    template <class Visit>
    void for_each_pair(const Visit& visit) const {
        for (const PolygonHalfEdge& e : edges_) {
            if (e.twin >= 0) visit(e.polygon, edges_[index(e.twin)].polygon);
        }
    }
    /// Parts pairs again unless may_stay(one, other) holds of their polygons.
    template <class MayStay>
    void separate(const MayStay& may_stay) {
        for (PolygonHalfEdge& e : edges_) {
            if (e.twin < 0 || may_stay(e.polygon, edges_[index(e.twin)].polygon)) continue;
            edges_[index(e.twin)].twin = -1;
            e.twin = -1;
        }
    }
    /// Calls visit(half-edges) for the outlines, in the order of their first half-edges.
    template <class Visit>
    void for_each_outline(const Visit& visit) {
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
            visit(std::span<const PolygonHalfEdge>(outline_));
        }
    }
    /// Takes all polygons away: their memory is kept for others.
    void clear() { edges_.clear(); }

private:
    using KeyedEdge = std::pair<std::uint64_t, std::int32_t>;  ///< packed nodes, half-edge

    std::vector<PolygonHalfEdge> edges_;
    std::vector<KeyedEdge> order_;    ///< by the edges' nodes
    std::vector<std::uint8_t> done_;  ///< of half-edges
    std::vector<PolygonHalfEdge> outline_;
};

}  // namespace realmodel::arrangement
