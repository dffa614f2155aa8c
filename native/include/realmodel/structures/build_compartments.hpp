// SPDX-License-Identifier: GPL-3.0-or-later
// A model with faults and bodies from its surfaces (docs/dev/structures.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/strata/stack.hpp"
#include "realmodel/structures/structures.hpp"

namespace realmodel::structures {

/// What a surface of a stack in one compartment is in the whole model.
struct CompartmentSurface {
    std::int32_t number;  ///< its own; kWall, kBase or kCutFace: none of the whole's
    std::int32_t block;   ///< that of the block beneath it; -1: nothing is there
    /// Of each of its triangles the number in the surface of the whole, which errors and warnings
    /// name; none at all: they are all there.
    std::span<const std::int64_t> triangles = {};
};

/// A rock mass as it is in one compartment.
struct CompartmentStack {
    strata::StackInput stack;                  ///< without surfaces: it is not there
    std::vector<CompartmentSurface> surfaces;  ///< one for each of the stack
};

/// A closed surface that divides one compartment, such as the boundary of where the field of a
/// series is at most the level of a surface.
struct LevelSolid {
    TriangleView boundary;
    std::int32_t surface;  ///< what faces on it are in the whole model
};

/// The rock masses as they are between the solids of a compartment.
struct LevelCompartment {
    Sides sides;                          ///< of the solids: 1 outside, -1 inside, 0 on either side
    std::vector<CompartmentStack> rocks;  ///< one for each rock mass
};

/// One of the compartments that structures leave. What its stacks build may reach beyond it: the
/// structures cut it.
struct CompartmentInput {
    Sides sides;                          ///< as compartments_of has them
    std::vector<CompartmentStack> rocks;  ///< one for each rock mass; with solids none
    /// Of columns: those that lie nowhere in it need not be made.
    std::optional<strata::WantedSpace> wanted = {};
    /// Solids that divide it, and what is between them. A solid ends cells only where the blocks on
    /// its two sides differ.
    std::vector<LevelSolid> solids = {};
    std::vector<LevelCompartment> between = {};
};

/// A piece of a whole model, with structures continued as in the whole.
struct PieceOfWhole {
    std::vector<ContinuedStructure> continued;  ///< one for each structure; none: as far as it goes
    double largest = 0;                         ///< the largest coordinate of the whole
};

/// A model with structures, compartment by compartment.
struct StructuredInput {
    std::vector<CompartmentInput> compartments;
    std::vector<Structure> structures;
    /// S x B: whether a structure divides a block, numbered as CompartmentSurface::block has them.
    std::span<const std::uint8_t> acts;
    std::int32_t surfaces = 0;  ///< of the whole: structures are counted after them
    std::size_t blocks = 0;     ///< B
    CellKind cells = CellKind::kColumns;
    std::optional<PieceOfWhole> piece = {};
};

/// Builds the stacks of all compartments, several at once, cuts them by the structures and joins
/// them: join_models of their models. Where a compartment has solids, the stacks between them are
/// joined so before. Stacks with `emptied` are built as columns, whatever cells are
/// wanted. The warnings are those of all compartments, each once.
/// @return cell_compartment  of each cell the compartment
/// @throws InputError  as build_rock_masses does, `surface` and the items that are triangles as
///         the whole has them; as join_models does, `surface` the number of the structure counted
///         after all surfaces; bad_part (item: the compartment that does not fit the rest)
/// @throws Cancelled
Joined build_compartments(const StructuredInput& input, const Execution& execution);

}  // namespace realmodel::structures
