// SPDX-License-Identifier: GPL-3.0-or-later
#include "pieces.hpp"

#include <algorithm>
#include <numeric>

namespace realmodel::strata {

const std::vector<std::int32_t>& PieceFinder::overlapping(PolygonView outline) {
    layer_.grid.candidates(scope_, outline, candidates_);
    overlapping_.clear();
    for (const std::int32_t c : candidates_) {
        if (clipper_.overlap(outline, layer_.polygons[static_cast<std::size_t>(c)])) {
            overlapping_.push_back(c);
        }
    }
    return overlapping_;
}

const Pieces& PieceFinder::find(PolygonView outline, PlaneId plane) {
    pieces_.clear();
    layer_.grid.candidates(scope_, outline, candidates_);
    for (const std::int32_t c : candidates_) {
        const PolygonView common =
            clipper_.intersect(outline, layer_.polygons[static_cast<std::size_t>(c)]);
        if (common.empty()) continue;
        const PlaneId surface = layer_.plane[static_cast<std::size_t>(c)];
        if (surface < 0) {
            add(c, Side::kAbsent, common, kVoid, kVoid);
        } else if (plane == kSky) {
            add(c, Side::kBelow, common, kVoid, kVoid);
        } else if (plane == kVoid) {
            add(c, Side::kNotBelow, common, kVoid, kVoid);
        } else {
            common_.assign(common.begin(), common.end());
            classify(c, plane, common_);
        }
    }
    return pieces_;
}

void PieceFinder::classify(std::int32_t polygon, PlaneId facet_plane, PolygonView common) {
    const PlaneId surface = layer_.plane[static_cast<std::size_t>(polygon)];
    bool lower = false, higher = false;
    if (surface != facet_plane) {
        const auto trace = scope_.shared().trace_filter(surface, facet_plane);
        for (const Corner& corner : common) {
            const int sign = scope_.compare_heights(surface, facet_plane, trace, corner.point);
            lower |= sign < 0;
            higher |= sign > 0;
        }
    }
    if (!lower || !higher) {
        add(polygon, lower ? Side::kBelow : Side::kNotBelow, common, surface, facet_plane);
        return;
    }
    const DirectedLine above = scope_.trace(surface, facet_plane);
    add(polygon, Side::kBelow, clipper_.cut(common, exact::opposite(above)), surface, facet_plane);
    add(polygon, Side::kNotBelow, clipper_.cut(common, above), surface, facet_plane);
}

void PieceFinder::add(std::int32_t polygon, Side side, PolygonView outline, PlaneId lower,
                      PlaneId upper) {
    const auto first = static_cast<std::int64_t>(pieces_.corners.size());
    for (const Corner& corner : outline) {
        pieces_.corners.push_back(corner);
        const bool touches = side == Side::kBelow && lower >= 0 &&
                             scope_.compare_heights(lower, upper, corner.point) == 0;
        pieces_.touches.push_back(touches ? 1 : 0);
    }
    pieces_.list.push_back(
        {polygon, side, first, static_cast<std::int64_t>(pieces_.corners.size())});
}

std::int32_t PieceGrouping::root(std::int32_t piece) {
    while (parent_[static_cast<std::size_t>(piece)] != piece) {
        auto& up = parent_[static_cast<std::size_t>(piece)];
        up = parent_[static_cast<std::size_t>(up)];
        piece = up;
    }
    return piece;
}

// Whether the cell goes through the edge that two pieces share: it is thick there and the surface
// has no step.
bool PieceGrouping::joined(const Pieces& pieces, const Edge& a, const Edge& b) {
    if (!a.below || !b.below || a.thin || b.thin) return false;
    const auto plane = [&](const Edge& e) {
        const Piece& piece = pieces.list[static_cast<std::size_t>(e.piece)];
        return layer_.plane[static_cast<std::size_t>(piece.polygon)];
    };
    return scope_.compare_heights(plane(a), plane(b), a.from) == 0 &&
           scope_.compare_heights(plane(a), plane(b), a.to) == 0;
}

bool PieceGrouping::on_border(PolygonView facet, const Edge& edge) {
    return std::any_of(facet.begin(), facet.end(), [&](const Corner& side) {
        return scope_.side(side.line, edge.from) == 0 && scope_.side(side.line, edge.to) == 0;
    });
}

void PieceGrouping::collect_edges(const Pieces& pieces) {
    edges_.clear();
    for (std::size_t i = 0; i < pieces.list.size(); ++i) {
        const Piece& piece = pieces.list[i];
        for (std::int64_t c = piece.first; c < piece.last; ++c) {
            const auto here = static_cast<std::size_t>(c);
            const auto there = static_cast<std::size_t>(c + 1 < piece.last ? c + 1 : piece.first);
            edges_.push_back({pieces.corners[here].point, pieces.corners[there].point,
                              static_cast<std::int32_t>(i), piece.side == Side::kBelow,
                              pieces.touches[here] != 0 && pieces.touches[there] != 0});
        }
    }
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
        return std::pair(a.key(), a.piece) < std::pair(b.key(), b.piece);
    });
}

std::int32_t PieceGrouping::group(PolygonView facet, const Pieces& pieces,
                                  std::vector<std::int32_t>& group) {
    const auto count = static_cast<std::int32_t>(pieces.list.size());
    group.assign(static_cast<std::size_t>(count), -1);
    parent_.resize(static_cast<std::size_t>(count));
    std::iota(parent_.begin(), parent_.end(), 0);
    collect_edges(pieces);
    is_joined_.assign(edges_.size(), 0);
    for (std::size_t i = 0; i + 1 < edges_.size(); ++i) {
        const Edge &a = edges_[i], &b = edges_[i + 1];
        if (a.key() != b.key() || !joined(pieces, a, b)) continue;
        is_joined_[i] = is_joined_[i + 1] = 1;
        const std::int32_t low = std::min(root(a.piece), root(b.piece));
        const std::int32_t high = std::max(root(a.piece), root(b.piece));
        parent_[static_cast<std::size_t>(high)] = low;
    }
    // The border of a cell in plan must pass each point once, or the cell would touch itself in a
    // vertical edge; two of its pieces must not meet in an edge that does not join them; and where
    // an edge inside the facet has no partner (a long one faces two short ones) nothing is known.
    bool alone = false;
    border_.clear();
    for (std::size_t i = 0; i < edges_.size() && !alone; ++i) {
        const Edge& edge = edges_[i];
        if (!edge.below || is_joined_[i] != 0) continue;
        border_.emplace_back(root(edge.piece), edge.from);
        const bool before = i > 0 && edges_[i - 1].key() == edge.key();
        const bool after = i + 1 < edges_.size() && edges_[i + 1].key() == edge.key();
        if (!before && !after) {
            alone = !on_border(facet, edge);
        } else {
            const Edge& partner = edges_[before ? i - 1 : i + 1];
            alone = partner.below && root(partner.piece) == root(edge.piece);
        }
    }
    std::sort(border_.begin(), border_.end());
    alone |= std::adjacent_find(border_.begin(), border_.end()) != border_.end();

    std::int32_t cells = 0;
    for (std::int32_t i = 0; i < count; ++i) {
        if (pieces.list[static_cast<std::size_t>(i)].side != Side::kBelow) continue;
        auto& of_root = group[static_cast<std::size_t>(alone ? i : root(i))];
        if (of_root < 0) of_root = cells++;
        group[static_cast<std::size_t>(i)] = of_root;
    }
    return cells;
}

}  // namespace realmodel::strata
