// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/index.hpp"
#include "base/vectors.hpp"

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

}  // namespace realmodel::arrangement
