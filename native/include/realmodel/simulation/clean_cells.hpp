// SPDX-License-Identifier: GPL-3.0-or-later
/// The cells of a model without what solvers cannot compute on: short edges, thin faces and thin
/// cells (docs/dev/simulation.md, "Clean-up of the exact cells").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::simulation {

/// How many edges, faces and cells a complex has.
struct ComplexCounts {
    std::size_t edges = 0, faces = 0, cells = 0;
};

struct CleanedCells {
    CellComplex complex;  ///< `volumes` are of the blocks; vertices are some of the model's
    Array<std::int32_t> cell_origin;     ///< the cell of the model that each cell was
    std::vector<double> volumes_before;  ///< of the blocks
    ComplexCounts before, after;
    std::size_t short_edges = 0;  ///< left, because a cell would have been turned over
    std::size_t thin_cells = 0;   ///< the same
    double largest_move = 0;      ///< how far a vertex was moved at most
};

/// Joins the ends of edges shorter than the tolerance, gives up faces narrower than it by bringing
/// a vertex and the edge across from it together, and joins cells thinner than it with a neighbor.
/// Each step is done only where all cells around stay closed and connected, with a positive volume,
/// and where no face turns over. No vertex moves farther than the tolerance.
/// @param surface_kind  of each surface; faces on those of another kind than 0 (faults, bodies) do
///                      not vanish between two cells
/// @throws InputError kind bad_index; Cancelled
CleanedCells clean_cells(const ComplexView& model, std::span<const std::int32_t> surface_kind,
                         double tolerance, const Execution& execution);

}  // namespace realmodel::simulation
