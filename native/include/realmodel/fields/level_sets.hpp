// SPDX-License-Identifier: GPL-3.0-or-later
// Level sets of a scalar field on a regular lattice (docs/dev/series.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/array.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/fields/lattice.hpp"

namespace realmodel::fields {

/// A function in space that is linear on a lattice's tetrahedra, and on what points with values of
/// their own divide these into.
struct LatticeField {
    Lattice lattice;
    std::span<const double> values;        ///< one for each node
    std::span<const double> points;        ///< 3 P coordinates within the lattice
    std::span<const double> point_values;  ///< one for each
};

/// The boundary of where the function is at most a level, closed beyond the sides of the lattice:
/// triangles counter-clockwise seen from where it is greater.
struct LevelSet {
    Array<std::array<double, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::size_t on_level = 0;  ///< how many of these are the level set itself; the others close it
};

/// One for each level. No two of them cross in the lattice. A point whose value is a level is a
/// vertex of that level set, unless it is an extreme. The order of vertices and triangles does not
/// depend on the number of threads.
/// @param levels  ascending
/// @throws InputError  kinds bad_lattice (the text says what), not_finite; outside (items: the
///         point), two_values (items: two points in one position with different values); Cancelled
std::vector<LevelSet> level_sets(const LatticeField& field, std::span<const double> levels,
                                 const Execution& execution);

/// The values of nodes with those that are as near to a level as makes no difference moved onto it,
/// so that no level set has a vertex beside a node.
/// @throws InputError  kinds bad_lattice, not_finite
std::vector<double> moved_onto_levels(const LatticeField& field, std::span<const double> levels);

/// The function at positions (3 N coordinates); NaN outside the lattice.
/// @throws InputError  as level_sets does
std::vector<double> field_at(const LatticeField& field, std::span<const double> positions,
                             const Execution& execution);

/// The corners of the tetrahedra that positions are in, but for rounding: nodes by their numbers,
/// points counted after all nodes; and their weights there, which sum to 1.
struct TetrahedraAt {
    std::vector<std::array<std::int64_t, 4>> corners;
    std::vector<std::array<double, 4>> weights;
};

/// @param positions  3 N coordinates
/// @throws InputError  as level_sets does; outside (items: the position)
TetrahedraAt tetrahedra_at(const LatticeField& field, std::span<const double> positions,
                           const Execution& execution);

/// Of each point of a field whether beside it there are corners with lesser and with greater
/// values. Where there are not, the level set of its value does not pass through it.
/// @throws InputError  as level_sets does
std::vector<std::uint8_t> points_between(const LatticeField& field, const Execution& execution);

}  // namespace realmodel::fields
