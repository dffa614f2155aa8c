// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/vectors.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

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

}  // namespace realmodel::fields
