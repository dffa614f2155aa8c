// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>

#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

namespace {

/// Whether all that is around a part is one other part, which has nothing else around itself.
bool has_one_neighbor(const RoundedParts& parts, std::int32_t part) {
    const auto around = parts.pieces_of[index(part)];
    const auto beyond = [&](std::int32_t p) {
        const CutPiece& piece = parts.pieces[index(p)];
        return piece.sides[0] == piece.sides[1] ? piece.parts[piece.parts[0] == part ? 1 : 0] : -1;
    };
    if (around.empty()) return false;
    const std::int32_t other = beyond(around[0]);
    return other >= 0 && other != part && parts.pieces_of[index(other)].size() == around.size() &&
           std::ranges::all_of(around, [&](std::int32_t p) { return beyond(p) == other; });
}

}  // namespace

void drop_hollow(RoundedParts& parts) {
    CutPieces& pieces = parts.pieces;
    bool any = false;
    for (std::size_t part = 0; part < parts.half_cells.size(); ++part) {
        const auto around = parts.pieces_of[part];
        const auto number = static_cast<std::int32_t>(part);
        if (parts.has_far_faces[part] != 0) continue;
        if (has_one_neighbor(parts, number)) {
            any = true;
            for (const std::int32_t p : around)
                pieces[index(p)].parts = {-1, -1};
        }
        if (around.size() != 2) continue;
        const std::array both{index(around[0]), index(around[1])};
        const bool has_both = both[0] != both[1] && std::ranges::all_of(both, [&](std::size_t p) {
                                  return std::ranges::count(pieces[p].parts, number) == 1;
                              });
        if (!has_both) continue;
        assert(std::ranges::is_permutation(pieces.polygons[both[0]], pieces.polygons[both[1]]));
        any = true;
        std::array<std::size_t, 2> own{};
        std::array<std::int32_t, 2> beyond{};  // the parts of this half there, or none
        for (std::size_t k = 0; k < 2; ++k) {
            own[k] = pieces[both[k]].parts[0] == number ? 0 : 1;
            const auto& sides = pieces[both[k]].sides;
            beyond[k] = sides[0] == sides[1] ? pieces[both[k]].parts[1 - own[k]] : -1;
        }
        const std::size_t stays = beyond[0] < 0 ? 0 : 1, goes = 1 - stays;
        const std::int32_t next = beyond[goes] == beyond[stays] ? -1 : beyond[goes];
        pieces[both[stays]].parts[own[stays]] = next;
        pieces[both[goes]].parts[own[goes]] = -1;
        if (next >= 0) {
            pieces[both[stays]].cells[own[stays]] = parts.half_cells[index(next)].cell;
            pieces[both[goes]].parts = {-1, -1};
        } else if (beyond[stays] >= 0) {
            pieces[both[stays]].parts = pieces[both[goes]].parts = {-1, -1};
        }
    }
    if (any) parts.update();
}

}  // namespace realmodel::cutting
