// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

enum class CriticalKind : std::uint8_t { kMinimum, kSaddle, kMaximum };

struct CriticalPoint {
    std::int64_t node;
    CriticalKind kind;
};

/// The inner nodes at which a field that is linear on the lattice's tetrahedra has a critical
/// point: around them the neighbors that lie higher, or those that lie lower, are not one connected
/// part of the node's link (Banchoff 1970, "Critical points and curvature for embedded
/// polyhedral surfaces"). Of equal values the one at the node of the lower number is the lower.
/// @param values  of the nodes
/// @return        in the order of the nodes
/// @throws InputError kind "option" where the values are not as many as the nodes; Cancelled
std::vector<CriticalPoint> critical_points(const Lattice& lattice, std::span<const double> values,
                                           const Execution& execution = {});

}  // namespace realmodel::fields
