// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/closedness.hpp"

#include <algorithm>
#include <array>

namespace realmodel::strata {

bool are_closed(const CellComplex& complex) {
    struct Use {
        std::array<std::int32_t, 3> key;  ///< cell and edge, the lower vertex first
        std::int32_t direction;
    };
    std::vector<Use> uses;
    for (std::size_t f = 0; f < complex.face_cells.size(); ++f) {
        const std::int64_t begin = complex.face_offsets[f], end = complex.face_offsets[f + 1];
        for (std::int64_t i = begin; i < end; ++i) {
            const std::int32_t a = complex.face_vertices[static_cast<std::size_t>(i)];
            const std::int64_t next = i + 1 < end ? i + 1 : begin;
            const std::int32_t b = complex.face_vertices[static_cast<std::size_t>(next)];
            for (std::size_t side = 0; side < 2; ++side) {
                const std::int32_t cell = complex.face_cells[f][side];
                if (cell < 0) continue;
                const bool ahead = (a < b) == (side == 0);
                uses.push_back({{cell, std::min(a, b), std::max(a, b)}, ahead ? 1 : -1});
            }
        }
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.key < b.key; });
    for (std::size_t i = 0; i < uses.size();) {
        std::int32_t sum = 0;
        std::size_t end = i;
        for (; end < uses.size() && uses[end].key == uses[i].key; ++end)
            sum += uses[end].direction;
        if (sum != 0) return false;
        i = end;
    }
    return true;
}

}  // namespace realmodel::strata
