// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::spatial {

/// A point found near a position.
struct Neighbor {
    double squared_distance;
    std::int32_t point;  ///< its number
    auto operator<=>(const Neighbor&) const = default;
};

/// Finds the points nearest to a position in plan, by a k-d tree (nanoflann).
class NearestPoints {
public:
    /// @param points  x, y; finite; they must outlive this object and stay as they are
    explicit NearestPoints(std::span<const PlanPosition> points);
    ~NearestPoints();
    NearestPoints(NearestPoints&&) noexcept;
    NearestPoints& operator=(NearestPoints&&) noexcept;

    std::size_t size() const;
    const PlanPosition& point(std::int32_t number) const;

    /// The `count` points nearest to a position (all, where there are fewer), nearest first; of
    /// points at one distance those with the lower number come first, also where only some of them
    /// are taken. Several threads may ask at once.
    void find(const PlanPosition& position, std::size_t count, std::vector<Neighbor>& near) const;

    /// The same of the points that count: `counts` is not 0 there.
    /// @param count  no more than there are
    void find_among(const PlanPosition& position, std::size_t count,
                    std::span<const std::int32_t> counts, std::vector<Neighbor>& near) const;

    /// The points no farther than this from a position, in any order, each once; a few a little
    /// farther may be among them. Whether these are all: with more than `most` it gives up.
    bool within(const PlanPosition& position, double distance, std::size_t most,
                std::vector<Neighbor>& near) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

/// Finds the nearest points of nodes that lie close together: one search of the tree for a block of
/// nodes; then each node finds its own among the candidates,
/// as NearestPoints::find does. One for each thread.
class BlockNeighbors {
public:
    /// @param count  points wanted at each node; there are as many
    BlockNeighbors(const NearestPoints& tree, std::size_t count) : tree_(tree), count_(count) {}

    /// Finds the candidates of a block; false where it is too wide for that to pay: halve it. A
    /// single node is never too wide.
    bool prepare(std::span<const PlanPosition> nodes);

    /// Numbers of the points that may be near a node of the block, ascending.
    std::span<const std::int32_t> candidates() const { return candidates_; }

    /// The nearest to a node of the block, nearest first, as numbers of candidates; what is said of
    /// one node holds until the next is asked for.
    std::span<const std::int32_t> nearest(const PlanPosition& node);

    /// Of the k-th of `nearest`.
    double squared_distance(std::size_t k) const { return keys_[k]; }

private:
    const NearestPoints& tree_;
    std::size_t count_;
    std::vector<Neighbor> neighbors_;
    std::vector<std::int32_t> candidates_, order_;
    std::vector<double> x_, y_, squared_, keys_;
};

/// Finds the nearest points in each eighth of the directions: looks at tiles in rings around a
/// position until no farther point can be among those wanted. One for each thread.
class OctantSearch {
public:
    struct Wanted {
        std::size_t in_octant;  ///< at most so many in each
        std::size_t in_all;     ///< at most so many of these, the nearest
        std::size_t looked_at;  ///< only the so many nearest of all points count
        double squared_radius;  ///< and only those no farther
    };

    OctantSearch(std::span<const PlanPosition> points, const Wanted& wanted);

    /// The points wanted, nearest first (of equals the lower number), but for `left_out`.
    void find(const PlanPosition& position, std::int32_t left_out, std::vector<Neighbor>& nearest);

private:
    void visit(std::size_t tile, const PlanPosition& position, std::int32_t left_out);
    /// Whether what lies beyond a distance can change nothing.
    bool complete(double squared_distance) const;

    std::span<const PlanPosition> points_;
    Wanted wanted_;
    PlanTiles tiles_;
    Buckets<std::int32_t> points_at_;  ///< of each tile
    std::vector<Neighbor> seen_;
    std::array<std::vector<Neighbor>, 8> taken_;
};

}  // namespace realmodel::spatial
