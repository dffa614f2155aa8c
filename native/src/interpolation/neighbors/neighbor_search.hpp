// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/linear_data.hpp"
#include "realmodel/interpolation/neighborhood.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// Refuses negative and infinite numbers.
/// @throws InputError kind "option"
void check_neighborhood(const Neighborhood& neighborhood);

/// @param what   takes so much memory, e.g. "a spline through all of", followed by the points
/// @param fewer  the number of neighbors to suggest instead
/// @throws InputError kind "too_large" where there is less memory
void require_memory(double bytes, double points, const char* what, int fewer);

/// Finds the points of a neighborhood. One for each thread.
class NeighborSearch {
public:
    NeighborSearch(const DataPoints& data, const spatial::NearestPoints& tree,
                   const Neighborhood& neighborhood);

    static constexpr std::int32_t kNobody = -1;

    /// Finds the points around a position (local coordinates), nearest first, without `left_out`:
    /// at least one, unless the one left out is the only point.
    /// @return false where none lies within the radius; the nearest alone is found then
    bool find(const PlanPosition& position, std::vector<spatial::Neighbor>& neighbors,
              std::int32_t left_out = kNobody);

private:
    const spatial::NearestPoints& tree_;
    bool plain_;
    std::size_t limit_, octant_limit_;
    double squared_radius_;
    std::vector<spatial::Neighbor> candidates_;
    std::optional<spatial::OctantSearch> rings_;  // where the tree would be slow
};

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

    /// As NeighborSearch::find; `neighbors` gets the numbers of data. Dips help nothing where there
    /// is no point.
    bool find(const PlanPosition& position, std::vector<spatial::Neighbor>& neighbors,
              std::int32_t left_out = NeighborSearch::kNobody);

private:
    static constexpr double kNoRadius = 1e300;  // squares of positions are smaller

    const LinearData& data_;
    NeighborSearch points_;
    double squared_radius_;
    std::vector<spatial::Neighbor> dips_;
};

}  // namespace realmodel::interpolation
