// SPDX-License-Identifier: GPL-3.0-or-later
// The parts that a cell falls into.
#include <algorithm>
#include <cassert>
#include <set>
#include <vector>

#include "cutting/cell_cutter.hpp"
#include "cutting/shell.hpp"

namespace realmodel::cutting {

/// The side of what is numbered: pieces, then what is below and what is above each cap.
std::int8_t CellCutter::side_of(std::size_t local, std::span<const PieceRef> refs) const {
    if (local < refs.size())
        return pieces_[index(refs[local].piece)].sides[index(refs[local].which)];
    return (local - refs.size()) % 2 == 0 ? kBelow : kAbove;
}

/// The edges of the caps, as seen from below, beside the others.
void CellCutter::add_uses_of_caps(const Polygons& caps, std::int32_t pieces) {
    const auto own = static_cast<std::ptrdiff_t>(uses_.size());
    for (std::size_t c = 0; c < caps.size(); ++c) {
        const auto nodes = caps[c];
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const NodeId a = nodes[k], b = nodes[k + 1 < nodes.size() ? k + 1 : 0];
            uses_.push_back({unordered(a, b), pieces + 2 * static_cast<std::int32_t>(c),
                             static_cast<std::int8_t>(a < b ? 1 : -1), kBelow, true});
        }
    }
    std::sort(uses_.begin() + own, uses_.end());
    std::inplace_merge(uses_.begin(), uses_.begin() + own, uses_.end());
}

/// Joins what meets at an edge on one side of the plane: each cap with a face, and what finds no
/// partner. As often as the edge is used one way it is used the other: so it is within each pair,
/// and among all that stay together.
void CellCutter::join_at_edge(std::span<const Use> uses, std::int8_t side, std::int32_t pieces,
                              DisjointSets& sets) {
    const std::int32_t cap_side = side == kBelow ? 0 : 1;
    auto& faces = faces_at_edge_;
    faces.clear();
    for (const Use& use : uses) {
        if (use.local < pieces && use.side == side) faces.push_back(&use);
    }
    std::int32_t unpaired = -1;
    const auto join_unpaired = [&](std::int32_t local) {
        if (unpaired >= 0) sets.join(unpaired, local);
        unpaired = local;
    };
    for (const Use& cap : uses) {
        if (cap.local < pieces) continue;
        const auto met = std::ranges::find_if(faces, [&](const Use* face) {
            return face->direction == (side == kBelow ? -cap.direction : cap.direction);
        });
        if (met == faces.end()) {
            join_unpaired(cap.local + cap_side);
        } else {
            sets.join((*met)->local, cap.local + cap_side);
            faces.erase(met);
        }
    }
    for (const Use* face : faces)
        join_unpaired(face->local);
}

/// Joins pieces that meet along an edge. Where caps end at an edge each of them closes the part
/// whose face it meets there. False where one part would use an edge four times, though the model's
/// cells use theirs twice: then those edges are among the dissolved, to be tried again without.
bool CellCutter::find_parts(std::span<const PieceRef> refs, CellCut& result) {
    const auto pieces = static_cast<std::int32_t>(refs.size());
    const std::size_t count = refs.size() + 2 * result.caps.size();
    add_uses_of_caps(result.caps, pieces);
    DisjointSets sets(count);
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
        while (end < uses_.size() && uses_[end].key() == uses_[begin].key())
            ++end;
        for (const std::int8_t side : {kBelow, kAbove})
            join_at_edge({uses_.data() + begin, end - begin}, side, pieces, sets);
    }
    attach_hollows(refs, result, sets);
    std::vector<std::int32_t> root(count);
    for (std::size_t i = 0; i < count; ++i)
        root[i] = sets.find(static_cast<std::int32_t>(i));
    // a part that rounding has turned inside out may meet the one that it goes to along an edge
    if (model_.cell_kind != CellKind::kBlocks && !use_edges_twice(root, pieces)) return false;

    result.part.assign(count, -1);
    result.part_side.clear();
    std::vector<std::int32_t> number(count, -1);
    for (std::size_t i = 0; i < count; ++i) {
        auto& part = number[index(root[i])];
        if (part < 0) {
            part = static_cast<std::int32_t>(result.part_side.size());
            result.part_side.push_back(side_of(i, refs));
        }
        assert(result.part_side[index(part)] == side_of(i, refs));
        result.part[i] = part;
    }
    return true;
}

/// Whether each part uses its edges twice. If not, what was done at them is noted to be done
/// otherwise: slits are dissolved; where rounding has folded a cap over itself, its loops stay
/// undivided.
bool CellCutter::use_edges_twice(const std::vector<std::int32_t>& root, std::int32_t pieces) {
    const std::size_t dissolved_before = dissolved_.size();
    bool folded = false;
    std::vector<std::int32_t> parts;
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
        parts.clear();
        for (end = begin; end < uses_.size() && uses_[end].key() == uses_[begin].key(); ++end) {
            parts.push_back(root[index(uses_[end].local)]);
            if (uses_[end].local >= pieces) parts.push_back(root[index(uses_[end].local + 1)]);
        }
        std::sort(parts.begin(), parts.end());
        bool often = false;
        for (std::size_t i = 2; i < parts.size(); ++i)
            often = often || parts[i] == parts[i - 2];
        if (!often) continue;
        if (std::find(slits_.begin(), slits_.end(), uses_[begin].edge) != slits_.end()) {
            dissolved_.push_back(uses_[begin].edge);
        } else {
            folded = true;
        }
    }
    std::sort(dissolved_.begin(), dissolved_.end());
    if (dissolved_.size() > dissolved_before) return false;
    if (!folded || whole_loops_) return true;  // the model's cell may use an edge more often itself
    whole_loops_ = true;
    return false;
}

/// Joins the walls of hollows within parts with the parts around them.
void CellCutter::attach_hollows(std::span<const PieceRef> refs, const CellCut& result,
                                DisjointSets& sets) const {
    const auto count = static_cast<std::int32_t>(refs.size() + 2 * result.caps.size());
    std::vector<Position> corners;
    for (const std::int8_t side : {kBelow, kAbove}) {
        std::set<std::int32_t> shells;
        for (std::int32_t i = 0; i < count; ++i) {
            if (side_of(index(i), refs) == side) shells.insert(sets.find(i));
        }
        if (shells.size() < 2) continue;
        const auto each_polygon = [&](const VisitShellPolygon& visit) {
            for (std::int32_t i = 0; i < count; ++i) {
                if (side_of(index(i), refs) != side) continue;
                const bool is_cap = index(i) >= refs.size();
                const bool reversed = is_cap ? side == kAbove : refs[index(i)].which == 1;
                corners.clear();
                for (const NodeId node : is_cap ? result.caps[(index(i) - refs.size()) / 2]
                                                : pieces_.polygons[index(refs[index(i)].piece)])
                    corners.push_back(position(node));
                visit(sets.find(i), corners, reversed ? -1 : 1);
            }
        };
        join_hollows(each_polygon, sets);
    }
}

}  // namespace realmodel::cutting
