// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

void level_base(RoundedParts& parts) {
    for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
        if (parts.surface_of(p, kCutFace) != kBase) continue;
        const NodeId first = parts.model.face(index(parts.pieces[p].face))[0];
        for (const NodeId node : parts.pieces.polygons[p]) {
            if (parts.is_new(node)) parts.moving(node)[2] = parts.at(first)[2];
        }
    }
}

}  // namespace realmodel::cutting
