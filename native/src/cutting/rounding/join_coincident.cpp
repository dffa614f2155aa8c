// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <set>

#include "base/parallel.hpp"
#include "cutting/rounding/contraction.hpp"
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

namespace {

/// Has new nodes become the vertex of the model, or else the first new node, in their position.
/// @return these nodes
std::vector<NodeId> contract(const RoundedParts& parts, std::vector<NodeId>& becomes) {
    const auto& positions = parts.new_positions;
    const auto is_at = [&positions](const Position& p) {
        return [&positions, &p](std::int32_t i) { return positions[index(i)] == p; };
    };
    KeyTable first;  // of the new nodes in one position
    first.reserve(positions.size());
    spatial::Box box;
    const std::size_t vertices = parts.vertices.size();
    for (std::size_t i = 0; i < positions.size(); ++i) {
        box.include(positions[i]);
        const auto found = first.find_or_add(Positions::hash(positions[i]),
                                             static_cast<std::int32_t>(i), is_at(positions[i]));
        becomes[vertices + i] = static_cast<NodeId>(vertices) + found.number;
    }
    for (std::size_t v = 0; v < vertices; ++v) {
        const Position& p = parts.vertices[v];
        if (!box.contains(p)) continue;
        const std::int32_t found = first.find(Positions::hash(p), is_at(p));
        if (found >= 0) becomes[vertices + index(found)] = static_cast<NodeId>(v);
    }
    std::vector<NodeId> contracted;
    for (std::size_t node = vertices; node < becomes.size(); ++node) {
        becomes[node] = becomes[index(becomes[node])];  // the first in a position: a vertex there
        if (index(becomes[node]) != node) contracted.push_back(static_cast<NodeId>(node));
    }
    return contracted;
}

/// Takes contractions back until all parts around those that are left stay sound.
void keep_sound(const RoundedParts& parts, Contraction& contraction,
                const std::vector<NodeId>& contracted, const std::array<bool, 2>& touches) {
    auto& becomes = contraction.becomes;
    const CutPieces& pieces = parts.pieces;
    std::vector<std::uint8_t> is_involved(becomes.size(), 0);
    for (const NodeId node : contracted)
        is_involved[index(node)] = is_involved[index(becomes[index(node)])] = 1;
    std::set<std::int32_t> involved;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (std::ranges::none_of(pieces.polygons[p],
                                 [&](NodeId node) { return is_involved[index(node)] != 0; }))
            continue;
        for (const std::int32_t part : pieces[p].parts) {
            if (part >= 0) involved.insert(part);
        }
    }
    const auto stays_sound = [&](std::int32_t part, Contraction::Scratch& scratch) {
        const auto found = contraction.shape(part, scratch);
        return found && contraction.is_sound(*found, part) &&
               (found->touches == 0 || parts.model.cell_kind == CellKind::kBlocks ||
                touches[parts.half_cells[index(part)].side == kAbove ? 1 : 0]);
    };
    // what all of them are like at first is found on all threads
    const std::vector<std::int32_t> all(involved.begin(), involved.end());
    std::vector<std::uint8_t> is_sound(all.size());
    constexpr std::size_t kAtOnce = 1 << 6;
    parallel_workers((all.size() + kAtOnce - 1) / kAtOnce, parts.execution,
                     [&] {
                         return [&, scratch = Contraction::Scratch()](std::size_t chunk) mutable {
                             const std::size_t end = std::min(all.size(), (chunk + 1) * kAtOnce);
                             for (std::size_t i = chunk * kAtOnce; i < end; ++i)
                                 is_sound[i] = stays_sound(all[i], scratch) ? 1 : 0;
                         };
                     },
                     0.02);
    std::set<std::int32_t> open;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (is_sound[i] == 0) open.insert(all[i]);
    }
    if (open.empty()) return;
    const auto each_contracted = [&](std::int32_t part, const auto& visit) {
        for (const std::int32_t piece : parts.pieces_of[index(part)]) {
            for (const NodeId node : pieces.polygons[index(piece)]) {
                if (becomes[index(node)] != node) visit(node);
            }
        }
    };
    std::map<NodeId, std::set<std::int32_t>> parts_at;
    for (const std::int32_t part : all)
        each_contracted(part, [&](NodeId node) { parts_at[node].insert(part); });
    Contraction::Scratch scratch;
    while (!open.empty()) {
        const std::int32_t part = *open.begin();
        open.erase(open.begin());
        if (stays_sound(part, scratch)) continue;
        // its nodes stay apart; the parts around these are looked at again
        each_contracted(part, [&](NodeId node) {
            becomes[index(node)] = node;
            open.insert(parts_at[node].begin(), parts_at[node].end());
        });
        open.erase(part);
    }
}

}  // namespace

void join_coincident(RoundedParts& parts, const std::array<bool, 2>& touches, bool may_fold) {
    Contraction contraction(parts, may_fold);
    const std::vector<NodeId> nodes = contract(parts, contraction.becomes);
    if (nodes.empty()) return;
    keep_sound(parts, contraction, nodes, touches);
    contraction.apply();
}

}  // namespace realmodel::cutting
