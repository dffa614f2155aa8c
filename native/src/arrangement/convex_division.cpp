// SPDX-License-Identifier: GPL-3.0-or-later
// Regions in convex polygons.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "arrangement/triangulate.hpp"

namespace realmodel::arrangement {

namespace {

/// Whether a loop turns left or goes straight on, up to rounding, at one of its corners: from the
/// last corner before that is not in the same position to the first after. Of a way that is not
/// much longer than rounding nobody knows where it points, so ways to corners farther off are
/// looked at, too.
bool left_or_straight(const Loop& loop, std::size_t corner, const PlanePosition& rounding) {
    const std::size_t n = loop.size();
    const PlanePosition& at = loop[corner].at;
    std::size_t before = (corner + n - 1) % n, after = (corner + 1) % n;
    PlanePosition near{4 * rounding[0], 4 * rounding[1]};
    for (int widened = 0; widened < 4; ++widened) {
        const auto is_apart = [&](std::size_t i) {
            return std::abs(loop[i].at[0] - at[0]) > near[0] ||
                   std::abs(loop[i].at[1] - at[1]) > near[1];
        };
        while (before != corner && !is_apart(before))
            before = (before + n - 1) % n;
        while (after != corner && !is_apart(after))
            after = (after + 1) % n;
        const PlanePosition &a = loop[before].at, &c = loop[after].at;
        if (twice_area(a, at, c) < -slack(a, at, c, rounding)) return false;
        near.fill(64 * std::max(near[0], near[1]));
    }
    return true;
}

/// Whether the corners of a loop go there and back once along an axis, up to rounding. One that
/// turns left or goes straight on everywhere may still run back along itself, or wind round twice.
bool goes_there_and_back(const Loop& loop, std::size_t axis, const PlanePosition& rounding) {
    int changes = 0;
    double last = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const double step = loop[(i + 1) % loop.size()].at[axis] - loop[i].at[axis];
        if (std::abs(step) <= rounding[axis]) continue;
        if (last != 0 && (step > 0) != (last > 0)) ++changes;
        last = step;
    }
    return changes <= 2;
}

/// Convex polygons grown from triangles.
class Merger {
public:
    Merger(const std::vector<std::array<LoopCorner, 3>>& triangles, const PlanePosition& rounding)
        : rounding_(rounding), owner_(triangles.size()) {
        std::iota(owner_.begin(), owner_.end(), 0);
        for (const auto& t : triangles)
            polygons_.push_back({t.begin(), t.end()});
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const NodeId a = triangles[t][i].node, b = triangles[t][(i + 1) % 3].node;
                edges_.push_back(
                    {std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
            }
        }
        std::sort(edges_.begin(), edges_.end());
    }

    void merge(std::span<const std::array<NodeId, 2>> slits) {
        for (std::size_t i = 0; i + 1 < edges_.size(); ++i) {
            const Edge &e = edges_[i], &f = edges_[i + 1];
            if (e.low != f.low || e.high != f.high) continue;
            const bool pair = (i == 0 || !same(edges_[i - 1], e)) &&
                              (i + 2 == edges_.size() || !same(edges_[i + 2], e));
            if (!pair || e.forward == f.forward) continue;
            if (std::binary_search(slits.begin(), slits.end(), std::array{e.low, e.high})) continue;
            join(find(e.triangle), find(f.triangle), e.low, e.high);
        }
    }

    void write(Polygons& result) {
        for (std::size_t i = 0; i < polygons_.size(); ++i) {
            if (find(static_cast<std::int32_t>(i)) != static_cast<std::int32_t>(i)) continue;
            for (const LoopCorner& c : polygons_[i])
                result.nodes.push_back(c.node);
            result.close();
        }
    }

private:
    struct Edge {
        NodeId low, high;
        std::int32_t triangle;
        bool forward;
        auto operator<=>(const Edge&) const = default;
    };
    static bool same(const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; }

    std::int32_t find(std::int32_t i) {
        while (owner_[index(i)] != i)
            i = owner_[index(i)] = owner_[index(owner_[index(i)])];
        return i;
    }

    void join(std::int32_t one, std::int32_t two, NodeId p, NodeId q) {
        if (one == two) return;
        const Loop &a = polygons_[index(one)], &b = polygons_[index(two)];
        // the shared edge runs from a[i] to its next, and against that in b from j to its next
        const auto find_edge = [p, q](const Loop& loop) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const NodeId m = loop[i].node, n = loop[(i + 1) % loop.size()].node;
                if ((m == p && n == q) || (m == q && n == p)) return i;
            }
            return loop.size();
        };
        const std::size_t i = find_edge(a), j = find_edge(b);
        if (i == a.size() || j == b.size()) return;
        Loop merged;
        for (std::size_t k = 1; k <= a.size(); ++k)
            merged.push_back(a[(i + k) % a.size()]);
        const std::size_t seam = merged.size() - 1;
        for (std::size_t k = 2; k < b.size(); ++k)
            merged.push_back(b[(j + k) % b.size()]);
        const std::size_t n = merged.size();
        if (!left_or_straight(merged, 0, rounding_) || !left_or_straight(merged, seam, rounding_))
            return;
        if (!goes_there_and_back(merged, 0, rounding_) ||
            !goes_there_and_back(merged, 1, rounding_))
            return;
        for (std::size_t k = seam + 1; k < n; ++k) {
            for (std::size_t l = 0; l <= seam; ++l) {
                if (merged[k].node == merged[l].node) return;
            }
        }
        polygons_[index(one)] = std::move(merged);
        polygons_[index(two)].clear();
        owner_[index(two)] = one;
    }

    PlanePosition rounding_;
    std::vector<std::int32_t> owner_;
    std::vector<Loop> polygons_;
    std::vector<Edge> edges_;
};

}  // namespace

bool is_convex(const Loop& loop, const PlanePosition& rounding) {
    const std::size_t n = loop.size();
    if (n < 3) return false;
    for (std::size_t i = 0; i < n; ++i) {
        if (!left_or_straight(loop, i, rounding)) return false;
    }
    if (!goes_there_and_back(loop, 0, rounding) || !goes_there_and_back(loop, 1, rounding))
        return false;
    return !has_repeated(loop, &LoopCorner::node);
}

bool divide_convex(std::span<const Loop> loops, const PlanePosition& rounding,
                   std::span<const std::array<NodeId, 2>> slits, Polygons& result,
                   const CornerTurns& turns) {
    if (loops.size() == 1 && is_convex(loops[0], rounding)) {
        for (const LoopCorner& c : loops[0])
            result.nodes.push_back(c.node);
        result.close();
        return true;
    }
    std::vector<std::array<LoopCorner, 3>> triangles;
    const bool clean = triangulate(loops, rounding, triangles, turns);
    Merger merger(triangles, rounding);
    merger.merge(slits);
    merger.write(result);
    return clean;
}

}  // namespace realmodel::arrangement
