// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "realmodel/base/progress.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::structures {

/// A complex with some of its cells as one, and without others. Faces within a cell and between
/// cells that are left out go; a face whose first cell is left out turns round. Faces and vertices
/// keep their order. A new cell has the block of the first of its old ones; volumes and warnings
/// are not taken over.
/// @param number  of each cell its number in the result, 0, 1, ... in the order in which they come
///                up; -1: it is left out
/// @throws InputError kinds bad_model; bad_index (item: the cell with another number)
/// @throws Cancelled
CellComplex merge_cells(const ComplexView& complex, std::span<const std::int32_t> number,
                        Progress* progress = nullptr);

}  // namespace realmodel::structures
