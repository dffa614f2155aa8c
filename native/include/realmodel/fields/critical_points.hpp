// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/fields/lattice.hpp"
#include "realmodel/fields/level_sets.hpp"

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

/// What of a field is to stay as it is.
struct HeldData {
    std::span<const std::uint8_t> fixed;  ///< of nodes, then of points: whose values do not change
    std::span<const std::array<double, 3>> dips;     ///< where f rises along its normal
    std::span<const std::array<double, 3>> normals;  ///< of the dips
    std::span<const std::array<double, 3>> bounds;   ///< where a sign times f is no less than that
    std::span<const double> signs;                   ///< times a level
    std::span<const double> levels;
};

/// A field with as few critical points as its data allow.
struct RisingField {
    std::vector<double> values;                   ///< of the nodes
    std::vector<double> point_values;             ///< of the points
    std::vector<std::array<double, 3>> critical;  ///< where it has critical points inside still
};

/// A field that is linear on tetrahedra has no critical point where it rises in all of them along
/// one direction (Banchoff 1970). At each critical point its values are moved as little as they
/// must be for it to rise in the tetrahedra around along the direction in which it rises in the
/// mean; then at those that this makes beside it, until there are fewer. It stays as it is where
/// this fails: where it rises along no direction in the mean, as in the middle of a dome, where
/// held data forbid it, or where values would be moved by more than the field rises in the mean
/// from one node to the next.
/// @return  the same bytes for any number of threads
/// @throws InputError  as level_sets does; option; Cancelled
RisingField without_critical_points(const LatticeField& field, const HeldData& held,
                                    const Execution& execution = {});

}  // namespace realmodel::fields
