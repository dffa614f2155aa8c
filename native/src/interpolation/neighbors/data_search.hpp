// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "interpolation/linear_data.hpp"
#include "interpolation/neighbors/neighbor_search.hpp"

namespace realmodel::interpolation {

/// Finds the data of a neighborhood: the points as NeighborSearch does, then the differences of the
/// nearest dips. One for each thread.
class DataSearch {
public:
    DataSearch(const LinearData& data, const spatial::NearestPoints& tree,
               const Neighborhood& neighborhood)
        : data_(data),
          points_(data.points(), tree, neighborhood),
          squared_radius_(neighborhood.radius > 0 ? neighborhood.radius * neighborhood.radius
                                                  : kNoRadius) {}

    /// As NeighborSearch::find; `found` gets the numbers of data. Dips help nothing where there is
    /// no point.
    bool find(const Position& position, std::vector<spatial::Neighbor>& found,
              std::int32_t left_out = NeighborSearch::kNobody);

private:
    static constexpr double kNoRadius = 1e300;  // squares of positions are smaller

    const LinearData& data_;
    NeighborSearch points_;
    double squared_radius_;
    std::vector<spatial::Neighbor> dips_;
};

}  // namespace realmodel::interpolation
