// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The words of this folder, beside those of cutting (cutting/pieces.hpp), whose cutter is all
// structures together:
//
// structure     a fault, an open surface, or a body, a closed one
// continuation  of a fault beyond its border, as far as the rock reaches: it divides nothing, but
//               with it every way from one side to the other crosses the fault
// branch        a fault that ends at others; it is kept on one side of each (larger_side)
// tip           the border of a fault in the rock, where it dies out
// compartment   what is on the same sides of all structures (StructureSides). A model is made for
//               each; of its cells those parts are wanted that lie in its compartment
// sides         of a compartment, by structures: 1 above a fault or outside of a body, -1 below
//               or inside, 0 where the structure is not, or for either
// acts          a structure, on a block: it divides it. Others leave the cells on both sides as one
// sliver        a region no wider than rounding: two models have one surface there, but each was
//               rounded by itself. It joins nothing and refuses nothing
// piece, node   as in cutting: of the cells of all models together, whose equal vertices are one
// facing        two equal pieces of one part, against each other: they cancel (cancel_facing)
// touching      an edge that a part has more than twice: it is set apart there, or stays
//               (set_touching_apart)

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cutting/cutter.hpp"
#include "realmodel/structures/structures.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::structures {

/// All structures as one cutter, each triangle with the number of its structure. Faults
/// turn counter-clockwise seen from above, on the whole. Those that do not divide the rock by
/// themselves are continued beyond their borders as far as it reaches: straight up or down where
/// they end at a height, in their own plane where they end aside, along their mean plane where they
/// die out. There they divide nothing, but every way from one side to the other crosses them.
/// What of bodies is beyond the rock is in `single` alone.
struct StructureCutter {
    cutting::Cutter combined;
    std::vector<std::int32_t> structure;        ///< of triangles
    std::vector<std::uint8_t> is_continuation;  ///< of triangles
    std::vector<cutting::Cutter> single;        ///< each structure with its continuation
    /// Of faults, where it is given: the side of each that they end at where they are.
    std::vector<std::vector<std::int8_t>> end_sides;
};

/// @param rock  a box around the rock
/// @throws InputError  as compartments_of does
StructureCutter structure_cutter(std::span<const Structure> structures, const spatial::Box& rock);

/// The same of structures that are continued already, in their order.
StructureCutter structure_cutter(std::span<const Structure> structures,
                                 std::span<const ContinuedStructure> continued);

/// The first of some structures alone, with what continues it; the others are the faults that it
/// ends at.
StructureCutter cutter_of_first(std::span<const Structure> structures, const spatial::Box& rock);
/// The same.
/// @param cutters  of the structures, as checked_cutters has them
/// @param size  of the rock with all of them, as size_with has it: so far it is continued
StructureCutter cutter_of_first(std::span<const Structure> structures,
                                std::span<const cutting::Cutter> cutters, double size);

/// Structures, each alone, checked and oriented.
std::vector<cutting::Cutter> checked_cutters(std::span<const Structure> structures);
/// Of a box around some rock and structures.
double size_with(const spatial::Box& rock, std::span<const cutting::Cutter> structures);

/// What continues a fault around its border, however ragged that is: triangles between the border
/// and a rectangle in its mean plane, then that plane. So the continuation crosses neither itself
/// nor the fault, and it is the same however far it reaches. Holes of the fault are filled.
///
/// Nothing where the border crosses itself or turns over seen at right angles to that plane.
/// @param border   the edges that one triangle has, as that triangle runs
/// @param lengths  how far beyond the rectangle its parts reach, ascending
std::optional<std::vector<std::array<cutting::Position, 3>>> continued_in_mean_plane(
    const cutting::Cutter& fault, std::span<const std::array<cutting::NodeId, 2>> border,
    std::span<const double> lengths);

/// How much of a fault lies on each side of another one.
struct BranchSides {
    double above = 0, below = 0;  ///< areas
    bool meets = false;           ///< whether the faults themselves have a point in common
};

/// Of a fault that ends at another one, and of that with its continuation. Divided exactly, near
/// the rock and away from it.
BranchSides branch_sides(const StructureCutter& cutter, std::int32_t branch, std::int32_t other);

/// On which side of the other one the larger part of its area lies.
/// @throws InputError kinds does_not_meet, equal_halves
std::int8_t larger_side(const StructureCutter& cutter, std::int32_t branch, std::int32_t other);

}  // namespace realmodel::structures
