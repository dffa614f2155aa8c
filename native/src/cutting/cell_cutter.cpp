// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cell_cutter.hpp"

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace realmodel::cutting {

void CellCutter::cap(std::span<const PieceRef> refs, CellCut& result) {
    collect_uses(refs, true);
    close(refs, result);
}

void CellCutter::close(std::span<const PieceRef> refs, CellCut& result) {
    collect_open_edges(refs);
    trace_loops();
    result.caps.clear();
    result.is_clean = true;
    if (whole_loops_) {
        take_whole_loops(result.caps);
    } else if (!loops_.empty()) {
        result.is_clean = divide_convex(loops_, rounding_, slits_, result.caps, points_);
    }
}

/// Each loop as one polygon, several where it passes a node twice.
void CellCutter::take_whole_loops(Polygons& caps) const {
    std::vector<NodeId> path;
    for (const Loop& loop : loops_) {
        path.clear();
        for (const LoopCorner& corner : loop) {
            const auto met = std::find(path.begin(), path.end(), corner.node);
            if (path.end() - met >= 3) caps.add({met, path.end()});
            path.erase(met, path.end());
            path.push_back(corner.node);
        }
        if (path.size() >= 3) caps.add(path);
    }
}

void CellCutter::cut(std::span<const PieceRef> refs, CellCut& result) {
    do {
        collect_uses(refs, false);
        close(refs, result);
    } while (!find_parts(refs, result));
    dissolved_.clear();
    whole_loops_ = false;
}

void CellCutter::collect_uses(std::span<const PieceRef> refs, bool in_plane_only) {
    uses_.clear();
    for (std::size_t i = 0; i < refs.size(); ++i) {
        const auto piece = index(refs[i].piece);
        const auto nodes = pieces_.polygons[piece];
        const std::int8_t side = pieces_[piece].sides[index(refs[i].which)];
        const bool level = pieces_[piece].is_level != 0;
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const NodeId a = nodes[k], b = nodes[k + 1 < nodes.size() ? k + 1 : 0];
            if (in_plane_only && !(in_plane(a) && in_plane(b))) continue;
            const bool ahead = (a < b) == (refs[i].which == 0);
            uses_.push_back({unordered(a, b), static_cast<std::int32_t>(i),
                             static_cast<std::int8_t>(ahead ? 1 : -1), side, level});
        }
    }
    std::sort(uses_.begin(), uses_.end());
}

/// A node of a piece that is not in the plane.
NodeId CellCutter::far_node(const Use& use, std::span<const PieceRef> refs) const {
    for (const NodeId node : pieces_.polygons[index(refs[index(use.local)].piece)]) {
        if (!in_plane(node)) return node;
    }
    return use.edge[0];
}

/// Of an edge in the plane whose faces all rise from it, or all fall: whether the cell lies on both
/// sides of it. It does where the lowest of the rising faces, going round from the right side of
/// the edge, is one that the cell ends at.
bool CellCutter::caps_on_both_sides(std::span<const Use> uses,
                                    std::span<const PieceRef> refs) const {
    for (const std::int8_t side : {kAbove, kBelow}) {
        const Use* flattest = nullptr;
        for (const Use& use : uses) {
            if (use.side != side) continue;
            if (flattest == nullptr) {
                flattest = &use;
                continue;
            }
            // seen along the edge, angles are counted from the right over the top to the left
            const int orientation = points_.tetrahedron(
                use.edge[0], use.edge[1], far_node(*flattest, refs), far_node(use, refs));
            if (orientation * side > 0) flattest = &use;
        }
        if (flattest == nullptr) continue;
        return flattest->direction == (side == kAbove ? -1 : 1);
    }
    return false;
}

void CellCutter::collect_open_edges(std::span<const PieceRef> refs) {
    open_.clear();
    slits_.clear();
    for (std::size_t begin = 0; begin < uses_.size();) {
        std::size_t end = begin + 1;
        while (end < uses_.size() && uses_[end].key() == uses_[begin].key())
            ++end;
        const auto edge = uses_[begin].edge;
        if (in_plane(edge[0]) && in_plane(edge[1])) {
            int net = 0, above = 0, below = 0;
            bool level = false;
            for (std::size_t i = begin; i < end; ++i) {
                if (uses_[i].side == kAbove) net += uses_[i].direction;
                (uses_[i].side == kAbove ? above : below) += 1;
                level = level || uses_[i].level;
            }
            for (int i = 0; i < std::abs(net); ++i) {
                open_.push_back(net > 0 ? DirectedEdge{edge[0], edge[1]}
                                        : DirectedEdge{edge[1], edge[0]});
            }
            const bool may_pass = net == 0 && !level && (above > 1 || below > 1);
            if (may_pass && !std::binary_search(dissolved_.begin(), dissolved_.end(), edge) &&
                caps_on_both_sides({uses_.data() + begin, end - begin}, refs)) {
                slits_.push_back(edge);
            }
        }
        begin = end;
    }
    keep_slits_in_caps();
}

/// Whether the open edges go round the middle of an edge in the plane.
bool CellCutter::is_in_caps(const std::array<NodeId, 2>& edge) const {
    const PlanePosition a = corner(edge[0]).at, b = corner(edge[1]).at;
    const PlanePosition middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    int times = 0;
    for (const DirectedEdge& e : open_) {
        const PlanePosition p = corner(e.from).at, q = corner(e.to).at;
        if ((p[1] > middle[1]) == (q[1] > middle[1])) continue;
        if (q[1] > p[1] ? twice_area(p, q, middle) > 0 : twice_area(p, q, middle) < 0)
            times += q[1] > p[1] ? 1 : -1;
    }
    return times != 0;
}

/// A part of the cell's boundary may touch the plane where the cell has a face in it. There nothing
/// is open on either side, however steep the faces are that meet in the edge.
void CellCutter::keep_slits_in_caps() {
    std::erase_if(slits_, [this](const auto& edge) { return !is_in_caps(edge); });
    for (const auto& edge : slits_) {
        open_.push_back({edge[0], edge[1]});
        open_.push_back({edge[1], edge[0]});
    }
}

/// Of the edges that leave the node where one arrives, the first clockwise from the edge that
/// arrives: the one that bounds the same piece of the region, which lies to the left.
std::size_t CellCutter::next_edge(const DirectedEdge& arriving,
                                  const std::vector<bool>& taken) const {
    const auto begin = static_cast<std::size_t>(
        std::lower_bound(open_.begin(), open_.end(), arriving.to,
                         [](const DirectedEdge& e, NodeId node) { return e.from < node; }) -
        open_.begin());
    std::size_t best = open_.size();
    LoopCorner at{}, back{};
    const auto half = [&](const LoopCorner& p) {
        const int orientation = points_(at, back, p);
        if (orientation != 0) return orientation < 0 ? 0 : 2;
        const double along = (p.at[0] - at.at[0]) * (back.at[0] - at.at[0]) +
                             (p.at[1] - at.at[1]) * (back.at[1] - at.at[1]);
        return along < 0 ? 1 : 3;
    };
    for (std::size_t e = begin; e < open_.size() && open_[e].from == arriving.to; ++e) {
        if (taken[e]) continue;
        if (best == open_.size()) {
            best = e;
            continue;
        }
        at = corner(arriving.to);
        back = corner(arriving.from);
        const LoopCorner p = corner(open_[best].to), q = corner(open_[e].to);
        const int first = half(p), second = half(q);
        if (second < first || (second == first && points_(at, q, p) < 0)) best = e;
    }
    return best;
}

void CellCutter::trace_loops() {
    loops_.clear();
    std::sort(open_.begin(), open_.end(), [](const DirectedEdge& a, const DirectedEdge& b) {
        return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    std::vector<bool> taken(open_.size(), false);
    std::vector<Position> positions;
    for (std::size_t start = 0; start < open_.size(); ++start) {
        if (taken[start]) continue;
        Loop& loop = loops_.emplace_back();
        // As many edges arrive at each node as leave it: a walk can only end where it began.
        [[maybe_unused]] std::size_t last = start;
        for (std::size_t e = start; e < open_.size(); e = next_edge(open_[e], taken)) {
            assert(!taken[e]);
            taken[e] = true;
            last = e;
            positions.push_back(points_.rounded(open_[e].from));
            loop.push_back(corner(open_[e].from));
            if (open_[e].to == open_[start].from) {
                // further on only where the region goes on round this node
                const bool tied = std::count_if(open_.begin(), open_.end(), [&](const auto& o) {
                                      return o.from == open_[start].from;
                                  }) > 1;
                if (!tied) break;
                taken[start] = false;
                const std::size_t next = next_edge(open_[e], taken);
                taken[start] = true;
                if (next == start) break;
            }
        }
        assert(open_[last].to == open_[start].from);
    }
    rounding_ = points_.view().rounding(positions);
}

}  // namespace realmodel::cutting
