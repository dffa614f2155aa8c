// SPDX-License-Identifier: GPL-3.0-or-later
// Lattices as Python has them.
#pragma once

#include <pybind11/stl.h>

#include <array>
#include <tuple>

#include "realmodel/fields/lattice.hpp"

namespace realmodel::bindings {

/// origin, spacing, counts.
using LatticeTuple =
    std::tuple<std::array<double, 3>, std::array<double, 3>, std::tuple<int, int, int>>;

inline fields::Lattice lattice_of(const LatticeTuple& of) {
    const auto& [origin, spacing, counts] = of;
    const auto [nx, ny, nz] = counts;
    return {origin, spacing, {nx, ny, nz}};
}

}  // namespace realmodel::bindings
