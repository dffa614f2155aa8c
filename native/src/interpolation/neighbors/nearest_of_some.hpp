// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/base/execution.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// Points of which no two lie at one position, by their numbers from 0: at(number). They may be
/// more than the memory holds.
struct DistinctPoints {
    std::size_t size;
    std::function<PlanPosition(std::size_t)> at;
};

/// So many points are kept in memory; of more only those that matter.
inline constexpr std::size_t kMostInMemory = 1 << 18;

/// The points nearest to some of them: of each `count` (all, where there are fewer), one after
/// another, as NearestPoints::find gives them; the first is the point itself. Of many points there
/// is one tree after another, each of a part of them.
/// @param most  of points in a tree
std::vector<spatial::Neighbor> nearest_of_some(const DistinctPoints& positions,
                                               std::span<const std::int32_t> asked,
                                               std::size_t count, const Execution& execution,
                                               std::size_t most = kMostInMemory);

}  // namespace realmodel::interpolation
