// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "realmodel/base/execution.hpp"

namespace realmodel::strata {

/// Volume of every cell, by the divergence theorem about a corner of its own, so that coordinates
/// far from the origin cost no digits. The same for any number of threads.
/// @param vertices       of the complex, as CellComplex has them; so are the next three
/// @throws InputError kind bad_index where a face refers to a cell or a vertex that does not exist
/// @throws Cancelled
std::vector<double> cell_volumes(std::span<const std::array<double, 3>> vertices,
                                 std::span<const std::int64_t> face_offsets,
                                 std::span<const std::int32_t> face_vertices,
                                 std::span<const std::array<std::int32_t, 2>> face_cells,
                                 std::size_t cells, const Execution& execution = {});

}  // namespace realmodel::strata
