// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_sides.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "validation/chunked.hpp"

namespace realmodel::validation {

SidesByCell::SidesByCell(const ComplexView& model, const Execution& execution) {
    const std::size_t sides = model.face_cells.size(), cells = model.cell_count();
    const auto produce = [&](std::size_t chunk, const auto& put) {
        for (std::size_t i = chunk * kItemsOfChunk, end = std::min(sides, i + kItemsOfChunk);
             i < end; ++i) {
            const std::int32_t cell = model.face_cells[i];
            if (cell >= 0) put(index(cell), static_cast<Side>(i));
        }
    };
    const std::size_t chunks = (sides + kItemsOfChunk - 1) / kItemsOfChunk;
    Buckets<Side>::operator=(sorted_in_buckets<Side>(cells, chunks, produce, execution));
}

}  // namespace realmodel::validation
