// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "cutting/rounding/equal_pieces.hpp"
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

namespace {

/// A piece, and the one of its sides that is within a half where the other side is not.
struct Outer {
    std::size_t piece, which;
    int winding;
};

/// Of equal polygons of one half: those that face each other from outside of it become one between
/// their parts, which is added to `glued`, or none in one part. Whether there were any.
bool glue(RoundedParts& parts, std::span<const std::size_t> equal, std::int8_t half,
          CutPieces& glued, std::vector<std::uint8_t>& is_doubled) {
    CutPieces& pieces = parts.pieces;
    bool any = false;
    std::vector<Outer> outers;
    for (const std::size_t p : equal) {
        const auto& sides = pieces[p].sides;
        for (std::size_t k = 0; k < 2; ++k) {
            if (pieces[p].parts[k] < 0 || sides[k] != half) continue;
            if (pieces[p].parts[1 - k] >= 0 && sides[1 - k] == half) continue;
            const int winding = winding_of(pieces.polygons[p]);
            const Outer own{p, k, k == 0 ? winding : -winding};
            const auto against = std::ranges::find(outers, -own.winding, &Outer::winding);
            if (against == outers.end()) {
                if (!outers.empty()) is_doubled[p] = 1;
                outers.push_back(own);
                continue;
            }
            any = true;
            const std::array met{pieces[against->piece].parts[against->which], pieces[p].parts[k]};
            if (met[0] != met[1]) {
                const auto cell = [&](std::size_t i) {
                    return parts.half_cells[index(met[i])].cell;
                };
                const CutPiece between{-1, {cell(0), cell(1)}, {half, half}, false, met};
                const auto nodes = pieces.polygons[against->piece];
                if (against->which == 1) {
                    glued.add_reversed(nodes, between);
                } else {
                    glued.add(nodes, between);
                }
            }
            pieces[against->piece].parts[against->which] = pieces[p].parts[k] = -1;
            outers.erase(against);
        }
    }
    return any;
}

}  // namespace

std::vector<std::uint8_t> glue_doubled(RoundedParts& parts) {
    CutPieces glued;
    std::vector<std::uint8_t> is_doubled(parts.pieces.size(), 0);
    bool any = false;
    for (const auto& equal : equal_pieces(parts)) {
        for (const std::int8_t half : {kBelow, kAbove})
            any = glue(parts, equal, half, glued, is_doubled) || any;
    }
    if (!any) return is_doubled;
    std::vector<std::uint8_t> glued_doubled(glued.size(), 0);
    for (std::size_t p = 0; p < is_doubled.size(); ++p) {
        if (parts.pieces[p].parts[0] < 0 && parts.pieces[p].parts[1] < 0) continue;
        glued.add(parts.pieces.polygons[p], parts.pieces[p]);
        glued_doubled.push_back(is_doubled[p]);
    }
    parts.replace_pieces(std::move(glued));
    drop_hollow(parts);
    return glued_doubled;
}

}  // namespace realmodel::cutting
