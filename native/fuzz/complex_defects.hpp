// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "stack_case.hpp"

namespace realmodel::fuzz {

/// Something that a model must not be: its kind in a few words, which the minimizer holds on to,
/// and a sentence.
struct Defect {
    std::string kind, sentence;
};

using Cells = strata::CellKind;

/// Tests 1 to 4 of docs/dev/geometry.md on the arrays alone: shapes, vertices distinct and in use,
/// no face repeats a vertex, cells closed (blocks: edges balanced), with positive volume up to
/// rounding, walls vertical, other faces convex in plan, stated volumes those of the cells.
std::vector<Defect> complex_defects(const strata::CellComplex& complex, Cells cells);

/// Faces whose middle lies on no plane of a triangle, nearby in plan, of the surface that they
/// name.
std::vector<Defect> surface_defects(const strata::CellComplex& complex, const StackCase& stack);

/// Whether the builder made borders one that differ by rounding: what lay between them is gone
/// then.
bool were_borders_joined(const strata::CellComplex& complex);

/// Volumes of the cells by the divergence theorem, each about one of its own vertices.
std::vector<double> cell_volumes(const strata::CellComplex& complex);

/// Area of the faces between each two blocks (-1 outside) on each surface (-1 walls, -2 bases), and
/// in which cells touch: what stays the same when columns are merged to blocks.
std::vector<Defect> boundary_differences(const strata::CellComplex& columns,
                                         const strata::CellComplex& blocks);

}  // namespace realmodel::fuzz
