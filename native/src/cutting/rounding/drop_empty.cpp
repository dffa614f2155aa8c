// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

void drop_empty(RoundedParts& parts) {
    std::vector<std::int32_t> number(parts.half_cells.size(), -1);
    for (const CutPiece& piece : parts.pieces.origins) {
        for (const std::int32_t own : piece.parts) {
            if (own >= 0) number[index(own)] = 0;
        }
    }
    std::vector<HalfCell> kept;
    for (std::size_t part = 0; part < number.size(); ++part) {
        if (number[part] < 0) continue;
        number[part] = static_cast<std::int32_t>(kept.size());
        kept.push_back(parts.half_cells[part]);
    }
    parts.half_cells = std::move(kept);
    for (CutPiece& piece : parts.pieces.origins) {
        for (std::int32_t& own : piece.parts) {
            if (own >= 0) own = number[index(own)];
        }
    }
}

}  // namespace realmodel::cutting
