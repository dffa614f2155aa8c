// SPDX-License-Identifier: GPL-3.0-or-later
// The parts that a cell falls into.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "cutting/cell_cut.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

using spatial::Box;

/// Joins pieces that meet along an edge. Where caps end at an edge each of them closes the part
/// whose face it meets there. False where one part would use an edge four times, though the model's
/// cells use theirs twice: then those edges are among the dissolved, to be tried again without.
bool CellCutter::find_parts(std::span<const PieceRef> refs, CellCut& result) {
    const auto pieces = static_cast<std::int32_t>(refs.size());
    const std::size_t count = refs.size() + 2 * result.caps.size();
    // the edges of the caps, as seen from below, beside the others
    const std::size_t own = uses_.size();
    for (std::size_t c = 0; c < result.caps.size(); ++c) {
        const auto nodes = result.caps[c];
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const NodeId a = nodes[k], b = nodes[k + 1 < nodes.size() ? k + 1 : 0];
            uses_.push_back({unordered(a, b), pieces + 2 * static_cast<std::int32_t>(c),
                             static_cast<std::int8_t>(a < b ? 1 : -1), kBelow, true});
        }
    }
    const auto by_edge = [](const Use& a, const Use& b) {
        return std::pair(a.edge, a.local) < std::pair(b.edge, b.local);
    };
    std::sort(uses_.begin() + static_cast<std::ptrdiff_t>(own), uses_.end(), by_edge);
    std::inplace_merge(uses_.begin(), uses_.begin() + static_cast<std::ptrdiff_t>(own), uses_.end(),
                       by_edge);
    DisjointSets sets(count);
    std::vector<const Use*> faces, caps;
    for (std::size_t begin = 0; begin < uses_.size();) {
        std::size_t end = begin + 1;
        while (end < uses_.size() && uses_[end].edge == uses_[begin].edge)
            ++end;
        for (const std::int8_t side : {kBelow, kAbove}) {
            const int turned = side == kBelow ? -1 : 1;  // of a cap and the face that it meets
            const std::int32_t cap_side = side == kBelow ? 0 : 1;
            faces.clear();
            caps.clear();
            for (std::size_t i = begin; i < end; ++i) {
                if (uses_[i].local >= pieces) {
                    caps.push_back(&uses_[i]);
                } else if (uses_[i].side == side) {
                    faces.push_back(&uses_[i]);
                }
            }
            // As often as the edge is used one way it is used the other: so it is within each pair,
            // and among all that find no partner, which stay together.
            std::int32_t unpaired = -1;
            const auto leave = [&](std::int32_t local) {
                if (unpaired >= 0) sets.join(unpaired, local);
                unpaired = local;
            };
            for (const Use* cap : caps) {
                const auto met = std::find_if(faces.begin(), faces.end(), [&](const Use* face) {
                    return face != nullptr && face->direction == turned * cap->direction;
                });
                if (met == faces.end()) {
                    leave(cap->local + cap_side);
                } else {
                    sets.join((*met)->local, cap->local + cap_side);
                    *met = nullptr;
                }
            }
            for (const Use* face : faces) {
                if (face != nullptr) leave(face->local);
            }
        }
        begin = end;
    }
    std::vector<std::int32_t> root(count);
    for (std::size_t i = 0; i < count; ++i)
        root[i] = sets.find(static_cast<std::int32_t>(i));

    attach_shells(refs, result, root);
    // a part that rounding has turned inside out may meet the one that it goes to along an edge
    if (!model_.cells_are_blocks && !use_edges_twice(root, pieces)) return false;

    result.part.assign(count, -1);
    std::vector<std::int32_t> number(count, -1);
    result.part_side.clear();
    for (std::size_t i = 0; i < count; ++i) {
        auto& part = number[index(root[i])];
        if (part < 0) {
            part = static_cast<std::int32_t>(result.part_side.size());
            const std::int8_t side = i < refs.size()
                                         ? pieces_[index(refs[i].piece)].sides[index(refs[i].which)]
                                     : (i - refs.size()) % 2 == 0 ? kBelow
                                                                  : kAbove;
            result.part_side.push_back(side);
        }
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
        for (end = begin; end < uses_.size() && uses_[end].edge == uses_[begin].edge; ++end) {
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

/// The wall of a hollow within a part is a boundary of its own: one with a negative volume. It goes
/// to the part around it. So do parts that rounding has turned inside out.
void CellCutter::attach_shells(std::span<const PieceRef> refs, CellCut& result,
                               std::vector<std::int32_t>& root) {
    const auto side_of = [&](std::size_t i) {
        if (i >= refs.size()) return (i - refs.size()) % 2 == 0 ? kBelow : kAbove;
        return pieces_[index(refs[i].piece)].sides[index(refs[i].which)];
    };
    for (const std::int8_t side : {kBelow, kAbove}) {
        std::vector<std::int32_t> roots;
        for (std::size_t i = 0; i < root.size(); ++i) {
            if (side_of(i) == side && root[i] == static_cast<std::int32_t>(i))
                roots.push_back(root[i]);
        }
        if (roots.size() < 2) continue;
        std::vector<double> volume(root.size(), 0.0);
        std::vector<Box> box(root.size());
        const Position origin = position(pieces_.polygons[index(refs[0].piece)][0]);
        for (std::size_t i = 0; i < root.size(); ++i) {
            if (side_of(i) != side) continue;
            const bool cap = i >= refs.size();
            const auto nodes =
                cap ? result.caps[(i - refs.size()) / 2] : pieces_.polygons[index(refs[i].piece)];
            const bool reversed = cap ? (i - refs.size()) % 2 == 1 : refs[i].which == 1;
            const auto r = index(root[i]);
            const Position first = position(nodes[0]);
            for (std::size_t k = 0; k < nodes.size(); ++k) {
                box[r].include(position(nodes[k]));
                if (k < 2) continue;
                const double part =
                    sixfold_volume(origin, first, position(nodes[k - 1]), position(nodes[k]));
                volume[r] += reversed ? -part : part;
            }
        }
        std::int32_t largest = roots[0];
        for (const std::int32_t r : roots) {
            if (volume[index(r)] > volume[index(largest)]) largest = r;
        }
        std::vector<std::int32_t> owner(root.size());
        std::iota(owner.begin(), owner.end(), 0);
        for (const std::int32_t r : roots) {
            if (volume[index(r)] >= 0 || r == largest) continue;
            owner[index(r)] = largest;
            for (const std::int32_t s : roots) {
                if (volume[index(s)] < volume[index(owner[index(r)])] && volume[index(s)] > 0 &&
                    box[index(s)].contains(box[index(r)]))
                    owner[index(r)] = s;
            }
        }
        for (std::size_t i = 0; i < root.size(); ++i) {
            if (side_of(i) == side) root[i] = owner[index(root[i])];
        }
    }
}

}  // namespace realmodel::cutting
