// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/wanted_space.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

namespace {

constexpr double kNear = 1e-6;  // of a cell: what is only beside a cell counts as in it

}  // namespace

WantedBoxes::WantedBoxes(const WantedSpace& space) : space_(space) {
    const auto [nx, ny, nz] = space.cells;
    assert(nz <= kMostLayers && space.is_wanted.size() == nx * ny * nz);
    layers_.resize(nx * ny, 0);
    for (std::size_t i = 0; i < space.is_wanted.size(); ++i) {
        if (space.is_wanted[i] != 0) layers_[i / nz] |= std::uint64_t{1} << (i % nz);
    }
}

bool WantedBoxes::any_in(const spatial::Box& box) const {
    const double top = space_.low[2] + space_.step[2] * static_cast<double>(space_.cells[2]);
    if (box.low[2] < space_.low[2] || box.high[2] > top) return true;
    const double beside = kNear * space_.step[2];
    const std::uint64_t layers =
        layers_up_to(box.high[2] + beside) & ~(layers_up_to(box.low[2] - beside) >> 1);
    std::array<std::size_t, 2> first{}, last{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double near = kNear * space_.step[axis];
        first[axis] = cell(axis, box.low[axis] - near);
        last[axis] = cell(axis, box.high[axis] + near);
    }
    for (std::size_t x = first[0]; x <= last[0]; ++x) {
        for (std::size_t y = first[1]; y <= last[1]; ++y) {
            if ((layers_[x * space_.cells[1] + y] & layers) != 0) return true;
        }
    }
    return false;
}

/// The layer of a height and those beneath it.
std::uint64_t WantedBoxes::layers_up_to(double height) const {
    return ~std::uint64_t{0} >> (kMostLayers - 1 - cell(2, height));
}

std::size_t WantedBoxes::cell(std::size_t axis, double coordinate) const {
    const double at = std::floor((coordinate - space_.low[axis]) / space_.step[axis]);
    return static_cast<std::size_t>(
        std::clamp(at, 0.0, static_cast<double>(space_.cells[axis] - 1)));
}

spatial::Box box_of(LocalArrangement& scope, PolygonView polygon, PlaneId plane) {
    spatial::Box box;
    const HeightRange heights = heights_of(scope.shared(), plane);
    for (const Corner& corner : polygon) {
        const auto [x, y] = scope.rounded(corner.point);
        box.include(spatial::Box::Position{x, y, heights.low});
        box.include(spatial::Box::Position{x, y, heights.high});
    }
    return box;
}

}  // namespace realmodel::strata
