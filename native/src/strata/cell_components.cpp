// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/cell_components.hpp"

#include <algorithm>
#include <string>

#include "disjoint_parts.hpp"
#include "parallel_chunks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

std::vector<std::int32_t> cell_components(std::span<const std::array<std::int32_t, 2>> face_cells,
                                          std::span<const std::int32_t> cell_block,
                                          const Progress* progress) {
    const auto cells = static_cast<std::int32_t>(cell_block.size());
    DisjointParts parts(cell_block.size());
    for (std::size_t f = 0; f < face_cells.size(); ++f) {
        poll(progress, f);
        const auto [first, second] = face_cells[f];
        if (std::max(first, second) >= cells || std::min(first, second) < -1) {
            throw InputError("bad_index",
                             "face " + std::to_string(f) + " names a cell that is not there", -1,
                             {static_cast<std::int64_t>(f)});
        }
        if (first < 0 || second < 0) continue;
        if (cell_block[static_cast<std::size_t>(first)] ==
            cell_block[static_cast<std::size_t>(second)]) {
            parts.join(first, second);
        }
    }
    std::vector<std::int32_t> component(cell_block.size());
    for (std::int32_t c = 0; c < cells; ++c) {
        poll(progress, static_cast<std::size_t>(c));
        component[static_cast<std::size_t>(c)] = parts.find(c);
    }
    return component;
}

}  // namespace realmodel::strata
