// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "spatial/box_tree.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// The most layers that a grid may have.
inline constexpr std::size_t kMostLayers = 64;

/// Answers whether anything is wanted in a box. Above and below the grid it is, beside the grid as
/// in its nearest cells.
class WantedBoxes {
public:
    explicit WantedBoxes(const WantedSpace& space);

    bool any_in(const spatial::Box& box) const;

private:
    std::uint64_t layers_up_to(double height) const;
    std::size_t cell(std::size_t axis, double coordinate) const;

    WantedSpace space_;
    std::vector<std::uint64_t> layers_;  ///< of each place in plan, a bit for each layer
};

/// Around a polygon in the plane of a triangle: as high as the triangle is.
spatial::Box box_of(LocalArrangement& scope, PolygonView polygon, PlaneId plane);

}  // namespace realmodel::strata
