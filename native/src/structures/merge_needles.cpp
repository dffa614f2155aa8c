// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "structures/joined_rounding.hpp"
#include "structures/narrow.hpp"
#include "structures/wanted_parts.hpp"

namespace realmodel::structures {

using cutting::CutPiece;
using cutting::Position;
using cutting::RoundedParts;

namespace {

bool is_narrow(const RoundedParts& parts, std::int32_t piece, double least_rounding) {
    std::vector<Position> corners;
    for (const cutting::NodeId node : parts.pieces.polygons[index(piece)])
        corners.push_back(parts.at(node));
    Narrow narrow(least_rounding);
    narrow.add(corners, false);
    return static_cast<bool>(narrow);
}

}  // namespace

void merge_needles(RoundedParts& parts, double least_rounding) {
    const double allowed = std::max(cutting::rounding_of(parts.vertices), least_rounding);
    const auto is_needle = [&](std::int32_t part) {
        return parts.has_far_faces[index(part)] == 0 &&
               std::ranges::all_of(parts.pieces_of[index(part)], [&](std::int32_t piece) {
                   return is_narrow(parts, piece, allowed);
               });
    };
    std::vector<std::int32_t> into(parts.half_cells.size());
    std::iota(into.begin(), into.end(), 0);
    const auto find = [&into](std::int32_t part) {
        while (part >= 0 && into[index(part)] != part)
            part = into[index(part)];
        return part;
    };
    bool any = false;
    for (const CutPiece& piece : parts.pieces.origins) {
        if (piece.face >= 0 || WantedParts::surface_of_cap(piece.face) != kWall) continue;
        const std::int32_t one = find(piece.parts[0]), other = find(piece.parts[1]);
        if (one < 0 || other < 0 || one == other) continue;
        for (const auto& [needle, rest] : {std::pair(one, other), std::pair(other, one)}) {
            if (!is_needle(needle)) continue;
            into[index(needle)] = rest;
            any = true;
            break;
        }
    }
    if (!any) return;
    for (CutPiece& piece : parts.pieces.origins) {
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t part = find(piece.parts[k]);
            if (part == piece.parts[k]) continue;
            piece.parts[k] = part;
            piece.cells[k] = parts.half_cells[index(part)].cell;
            piece.sides[k] = parts.half_cells[index(part)].side;
        }
        if (piece.parts[0] == piece.parts[1]) piece.parts = {-1, -1};
    }
    parts.update();
}

}  // namespace realmodel::structures
