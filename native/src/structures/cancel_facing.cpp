// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <map>

#include "cutting/rounding/equal_pieces.hpp"
#include "cutting/rounding/part_rounding.hpp"
#include "structures/joined_rounding.hpp"

namespace realmodel::structures {

using cutting::CutPiece;
using cutting::CutPieces;
using cutting::NodeId;

void cancel_facing(cutting::RoundedParts& parts) {
    CutPieces& pieces = parts.pieces;
    std::vector<std::uint8_t> is_gone(pieces.size(), 0);
    CutPieces fresh;
    bool any = false;
    for (const auto& equal : cutting::equal_pieces(parts)) {
        std::map<std::int32_t, int> facing;  // of parts: how often a polygon faces away from each
        std::size_t before = 0;
        for (const std::size_t p : equal) {
            const int winding = cutting::winding_of(pieces.polygons[p]);
            for (std::size_t k = 0; k < 2; ++k) {
                if (pieces[p].parts[k] < 0) continue;
                facing[pieces[p].parts[k]] += k == 0 ? winding : -winding;
                ++before;
            }
        }
        std::array<std::vector<std::int32_t>, 2> left;  // parts that it faces away from, and faces
        for (const auto& [part, times] : facing) {
            auto& own = left[times > 0 ? 0 : 1];
            own.insert(own.end(), index(std::abs(times)), part);
        }
        assert(left[0].size() + left[1].size() <= before);
        if (left[0].size() + left[1].size() == before) continue;
        any = true;
        // what ends at no rock is what ended there before, not what was between two parts
        const bool ends = left[0].size() != left[1].size();
        const auto alike = std::ranges::find_if(equal, [&](std::size_t p) {
            return (pieces[p].parts[0] < 0 || pieces[p].parts[1] < 0) == ends;
        });
        const CutPiece& named = pieces[alike == equal.end() ? equal[0] : *alike];
        const auto first = pieces.polygons[equal[0]];
        std::vector<NodeId> nodes(first.begin(), first.end());
        if (cutting::winding_of(nodes) < 0) std::ranges::reverse(nodes);
        for (std::size_t i = 0; i < std::max(left[0].size(), left[1].size()); ++i) {
            CutPiece piece = named;
            for (std::size_t k = 0; k < 2; ++k) {
                const bool has_part = i < left[k].size();
                piece.parts[k] = has_part ? left[k][i] : -1;
                piece.cells[k] = has_part ? parts.half_cells[index(left[k][i])].cell : -1;
                piece.sides[k] = has_part ? parts.half_cells[index(left[k][i])].side : cutting::kOn;
            }
            fresh.add(nodes, piece);
        }
        for (const std::size_t p : equal)
            is_gone[p] = 1;
    }
    if (any) {
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            if (is_gone[p] == 0) fresh.add(pieces.polygons[p], pieces[p]);
        }
        parts.replace_pieces(std::move(fresh));
    }
    cutting::drop_hollow(parts);
}

}  // namespace realmodel::structures
