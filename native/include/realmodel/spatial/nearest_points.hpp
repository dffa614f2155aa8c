// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace realmodel::spatial {

/// A point found near a place.
struct Neighbour {
    double squared_distance;
    std::int32_t point;  ///< its number
    auto operator<=>(const Neighbour&) const = default;
};

/// Finds the points nearest to a place in plan, by a k-d tree (nanoflann).
class NearestPoints {
public:
    /// @param points  x, y; finite; they must outlive this object and stay as they are
    explicit NearestPoints(std::span<const std::array<double, 2>> points);
    ~NearestPoints();
    NearestPoints(NearestPoints&&) noexcept;
    NearestPoints& operator=(NearestPoints&&) noexcept;

    std::size_t size() const;

    /// The `count` points nearest to a place (all, where there are fewer), nearest first; of points
    /// at one distance those with the lower number come first, also where only some of them are
    /// taken. Several threads may ask at once.
    void find(const std::array<double, 2>& place, std::size_t count,
              std::vector<Neighbour>& found) const;

    /// The points no farther than this from a place, in any order, each once; a few a little
    /// farther may be among them. Whether these are all: with more than `most` it gives up.
    bool within(const std::array<double, 2>& place, double distance, std::size_t most,
                std::vector<Neighbour>& found) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace realmodel::spatial
