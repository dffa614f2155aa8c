// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/vectors.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

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
    std::array<std::size_t, 3> walk{0, 1, 2};
    std::stable_sort(walk.begin(), walk.end(),
                     [&](std::size_t a, std::size_t b) { return share[a] > share[b]; });
    const auto nx = static_cast<std::size_t>(lattice.counts[0]);
    const auto ny = static_cast<std::size_t>(lattice.counts[1]);
    const std::array<std::size_t, 3> strides{1, nx, nx * ny};
    std::size_t node = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        node += strides[axis] * static_cast<std::size_t>(cell[axis]);
    std::array<std::pair<std::size_t, double>, 4> out;
    double last = 1;
    for (std::size_t n = 0; n < 4; ++n) {
        const double next = n < 3 ? share[walk[n]] : 0;
        out[n] = {node, last - next};
        if (n < 3) node += strides[walk[n]];
        last = next;
    }
    return out;
}

}  // namespace realmodel::fields
