// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "base/vectors.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

/// The tetrahedron of a cell that a point lies in leads along edges from the cell's lowest corner
/// to the highest: along which axes, and the weights of its corners at the point.
struct Walk {
    std::array<std::size_t, 3> axes;
    std::array<double, 4> weights;
};

/// @param shares  of the cell's sides, from its lowest corner to the point
inline Walk walk_to(const Vec3& shares) {
    Walk walk{{0, 1, 2}, {}};
    std::ranges::stable_sort(walk.axes, std::greater<>(),
                             [&](std::size_t axis) { return shares[axis]; });
    double last = 1;
    for (std::size_t n = 0; n < 4; ++n) {
        const double next = n < 3 ? shares[walk.axes[n]] : 0;
        walk.weights[n] = last - next;
        last = next;
    }
    return walk;
}

/// The nodes of the tetrahedron that a point of the lattice lies in, with its weights.
inline std::array<std::pair<std::size_t, double>, 4> corners_at(const Lattice& lattice,
                                                                const Vec3& point) {
    std::array<int, 3> cell{};
    Vec3 share{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double place = (point[axis] - lattice.origin[axis]) / lattice.spacing[axis];
        cell[axis] = std::clamp(static_cast<int>(std::floor(place)), 0, lattice.counts[axis] - 2);
        share[axis] = place - cell[axis];
    }
    const auto nx = static_cast<std::size_t>(lattice.counts[0]);
    const auto ny = static_cast<std::size_t>(lattice.counts[1]);
    const std::array<std::size_t, 3> strides{1, nx, nx * ny};
    std::size_t node = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        node += strides[axis] * static_cast<std::size_t>(cell[axis]);
    const Walk walk = walk_to(share);
    std::array<std::pair<std::size_t, double>, 4> out;
    for (std::size_t n = 0; n < 4; ++n) {
        out[n] = {node, walk.weights[n]};
        if (n < 3) node += strides[walk.axes[n]];
    }
    return out;
}

}  // namespace realmodel::fields
