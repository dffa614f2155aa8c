// SPDX-License-Identifier: GPL-3.0-or-later
// Which points make a node's system. Private.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/octant_search.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// What a user may ask of neighbours.
struct Neighbourhood {
    int neighbours = 16;  ///< at most so many; 0: no limit
    int octants = 0;      ///< at most so many from each eighth of the directions; 0: no limit
    double radius = 0;    ///< none farther than this, in plan; 0: no limit

    bool plain() const { return octants == 0 && radius == 0; }
};

/// Throws InputError "option" for negative or infinite numbers.
void check_neighbourhood(const Neighbourhood& neighbourhood);

/// Finds the points of a neighbourhood. One for each thread.
class NeighbourSearch {
public:
    NeighbourSearch(const DataPoints& data, const spatial::NearestPoints& tree,
                    const Neighbourhood& neighbourhood);

    static constexpr std::int32_t nobody = -1;

    /// The points around a place (local coordinates), nearest first, but for `left_out`. There is
    /// always one, unless the one left out is all there is: where none lies within the radius the
    /// nearest alone, and the answer is false.
    bool find(const Place& place, std::vector<spatial::Neighbour>& found,
              std::int32_t left_out = nobody);

private:
    const spatial::NearestPoints& tree_;
    bool plain_;
    std::size_t limit_, octant_limit_;
    double squared_radius_;
    std::vector<spatial::Neighbour> candidates_;
    std::optional<OctantSearch> rings_;  // where the tree would be slow
};

}  // namespace realmodel::interpolation
