// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/vectors.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/fields/field.hpp"
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

/// The values of a smooth function at the nodes of a lattice. On a large lattice it is evaluated at
/// every other node along each axis; between these by cubic polynomials, whose error is of a higher
/// order in the spacing than that of functions linear on tetrahedra.
/// @param values_at  gives the values at positions
/// @param is_smooth  no: it is evaluated at all nodes
std::vector<double> lattice_values(
    const Lattice& lattice,
    const std::function<void(std::span<const Vec3>, std::span<double>)>& values_at,
    const Execution& execution, bool is_smooth = true);

/// Between nodes a linear function lies above one that bends upward, and below one that bends
/// downward: its level sets lie within folds. Node values from which the mean of this error over
/// the tetrahedra around them is taken err to neither side. Where a function is rough, less is
/// taken, so that few extremes are made.
std::vector<double> balanced(const std::vector<double>& values, const Lattice& lattice,
                             const Execution& execution);

/// Moves the values of nodes beside bounds as far as it takes for the function that is linear on
/// the lattice's tetrahedra to keep them: by projections onto one bound after another (Kaczmarz
/// 1937; Agmon 1954), in rounds. What contradicts others within one tetrahedron is left.
/// @param is_held  whether a bound is to be kept
void keep_bounds(const Lattice& lattice, const FieldData& data, std::span<const char> is_held,
                 std::span<const double> levels, std::vector<double>& values);

}  // namespace realmodel::fields
