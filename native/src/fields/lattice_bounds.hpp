// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "realmodel/fields/field.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

/// Moves the values of nodes beside bounds as far as it takes for the function that is linear on
/// the lattice's tetrahedra to keep them: by projections onto one bound after another (Kaczmarz
/// 1937; Agmon 1954), in rounds. What contradicts others within one tetrahedron is left.
/// @param kept  whether a bound is to be kept
void keep_bounds(const Lattice& lattice, const FieldData& data, std::span<const char> kept,
                 std::span<const double> levels, std::vector<double>& values);

}  // namespace realmodel::fields
