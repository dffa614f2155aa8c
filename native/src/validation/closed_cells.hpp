// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "validation/cell_sides.hpp"
#include "validation/edge_table.hpp"

namespace realmodel::validation {

/// An edge of a cell that is not closed there, or none. One thread, one table for all its cells.
std::optional<EdgeCount> open_edge(const ComplexView& model, std::span<const Side> sides,
                                   EdgeTable& table);

/// The same of a cell of many faces, on several threads.
std::optional<EdgeCount> open_edge_of_large_cell(const ComplexView& model,
                                                 std::span<const Side> sides,
                                                 const Execution& execution);

}  // namespace realmodel::validation
