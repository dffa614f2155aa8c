// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

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
    void find(const PlanPosition& position, std::size_t count, std::vector<Neighbor>& found) const;

    /// The points no farther than this from a position, in any order, each once; a few a little
    /// farther may be among them. Whether these are all: with more than `most` it gives up.
    bool within(const PlanPosition& position, double distance, std::size_t most,
                std::vector<Neighbor>& found) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace realmodel::spatial
