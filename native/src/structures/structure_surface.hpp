// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cutting/cutter_surface.hpp"
#include "realmodel/structures/structures.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::structures {

/// All structures as one surface that cuts, each triangle with the number of its structure. Faults
/// turn counter-clockwise seen from above, on the whole. Those that do not divide the rock by
/// themselves are continued beyond their borders as far as it reaches: straight up or down where
/// they end at a height, in their own plane where they end aside, along their mean plane where they
/// die out. There they divide nothing, but every way from one side to the other crosses them.
struct StructureSurface {
    cutting::CutterSurface surface;
    std::vector<std::int32_t> structure;         ///< of triangles
    std::vector<std::uint8_t> is_continuation;   ///< of triangles
    std::vector<cutting::CutterSurface> single;  ///< each structure with its continuation
    /// Of faults, where it is given: the side of each that they end at where they are.
    std::vector<std::vector<std::int8_t>> kept;
};

/// @param rock  a box around the rock
/// @throws InputError  as parts_of does
StructureSurface structure_surface(std::span<const Structure> structures, const spatial::Box& rock);

/// The same of structures that are continued already, in their order.
StructureSurface structure_surface(std::span<const Structure> structures,
                                   std::span<const ContinuedStructure> continued);

/// The first of some structures alone, with what continues it; the others are the faults that it
/// ends at.
StructureSurface first_surface(std::span<const Structure> structures, const spatial::Box& rock);

/// One structure alone, checked and oriented.
cutting::CutterSurface checked_surface(const Structure& structure, std::int32_t number);

}  // namespace realmodel::structures
