// SPDX-License-Identifier: GPL-3.0-or-later
// The nearest points in each eighth of the directions. Private.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// Looks at the cells of a grid in rings around a place until no farther point can be among those
/// wanted. One for each thread.
class OctantSearch {
public:
    struct Wanted {
        std::size_t in_octant;  ///< at most so many in each
        std::size_t in_all;     ///< at most so many of these, the nearest
        std::size_t looked_at;  ///< only the so many nearest of all points count
        double squared_radius;  ///< and only those no farther
    };

    OctantSearch(std::span<const Place> points, const Wanted& wanted);

    /// The points wanted, nearest first (of equals the lower number), but for `left_out`.
    void find(const Place& place, std::int32_t left_out, std::vector<spatial::Neighbour>& found);

private:
    void visit(std::size_t column, std::size_t row, const Place& place, std::int32_t left_out);
    /// Whether what lies beyond a distance can change nothing.
    bool complete(double squared_distance) const;

    std::span<const Place> points_;
    Wanted wanted_;
    Place low_{};
    double step_ = 1;
    std::array<std::size_t, 2> cells_{1, 1};
    std::vector<std::size_t> first_;  // of each cell in held_, and one more
    std::vector<std::int32_t> held_;
    std::vector<spatial::Neighbour> seen_;
    std::array<std::vector<spatial::Neighbour>, 8> taken_;
};

}  // namespace realmodel::interpolation
