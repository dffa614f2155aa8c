// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/pieces.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>

#include "base/disjoint_sets.hpp"
#include "base/vectors.hpp"

namespace realmodel::strata {

namespace {

/// Whether two convex polygons have the same corners.
bool same_corners(PolygonView a, PolygonView b) {
    if (a.size() != b.size()) return false;
    std::size_t j = 0;
    while (j < b.size() && b[j].point != a[0].point)
        ++j;
    if (j == b.size()) return false;
    for (const Corner& corner : a) {
        if (corner.point != b[j].point) return false;
        j = j + 1 < b.size() ? j + 1 : 0;
    }
    return true;
}

/// Twice the area of a polygon, seen from a position near it.
[[maybe_unused]] double twice_area(LocalArrangement& scope, PolygonView polygon,
                                   const std::array<double, 2>& origin) {
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto p = scope.rounded(polygon[i].point);
        const auto q = scope.rounded(polygon[i + 1 < polygon.size() ? i + 1 : 0].point);
        sum += realmodel::twice_area(origin, p, q);
    }
    return sum;
}

/// Whether pieces tile their facet, as far as the sum of rounded areas says.
[[maybe_unused]] bool tile(LocalArrangement& scope, const Pieces& pieces, PolygonView facet) {
    const auto origin = scope.rounded(facet[0].point);
    double reach = 0;
    for (const Corner& corner : facet) {
        const auto p = scope.rounded(corner.point);
        reach = std::max({reach, std::abs(p[0] - origin[0]), std::abs(p[1] - origin[1])});
    }
    const double area = twice_area(scope, facet, origin);
    double sum = 0;
    for (const Piece& piece : pieces.list)
        sum += twice_area(scope, pieces.outline(piece), origin);
    const double ulps = 0x1p-48 * (std::abs(origin[0]) + std::abs(origin[1]) + reach);
    return std::abs(sum - area) <=
           1e-9 * area + ulps * reach * static_cast<double>(4 + pieces.corners.size());
}

}  // namespace

/// Whether the outline is that of the polygon after the last that was one.
bool PieceFinder::is_expected(PolygonView outline) const {
    return expected_ < tiling_.polygons.size() &&
           same_corners(outline, tiling_.polygons[expected_]);
}

/// Finds polygons that may share an area with the outline. Where one is the outline, as on meshes
/// that surfaces have in common and where the frame is filled around equal borders, it is the only
/// one; whether so is the result.
bool PieceFinder::find_candidates(PolygonView outline) {
    if (is_expected(outline)) {
        candidates_.assign(1, static_cast<std::int32_t>(expected_++));
        return true;
    }
    tiling_.grid.candidates(scope_, outline, candidates_);
    for (const std::int32_t c : candidates_) {
        if (!same_corners(outline, outline_of(c))) continue;
        candidates_.assign(1, c);
        expected_ = static_cast<std::size_t>(c) + 1;
        return true;
    }
    return false;
}

std::span<const std::int32_t> PieceFinder::overlapping(PolygonView outline) {
    if (find_candidates(outline)) return {candidates_.begin(), candidates_.end()};
    overlapping_.clear();
    clipper_.begin(outline);
    for (const std::int32_t c : candidates_) {
        if (clipper_.overlaps(outline_of(c))) overlapping_.push_back(c);
    }
    return {overlapping_.begin(), overlapping_.end()};
}

const Pieces& PieceFinder::find(PolygonView outline, PlaneId plane, bool may_stay) {
    const EnvelopeFacet facet{
        outline, plane, plane.has_value() ? heights_of(scope_.shared(), plane) : HeightRange{}};
    pieces_.clear();
    const bool is_walked = !is_expected(outline) && walk_.begin(outline);
    if (!is_walked && find_candidates(outline)) {
        add_common(candidates_.front(), outline, facet);
    } else if (is_walked || (walk_.locate(outline, {candidates_.begin(), candidates_.end()}) &&
                             walk_.begin(outline))) {
        std::size_t higher = 0;
        while (may_stay && higher < walk_.size() && is_higher(walk_.polygon(higher), facet))
            ++higher;
        for (std::size_t i = 0; i < walk_.size(); ++i) {
            if (higher == walk_.size()) {
                add(walk_.polygon(i), PieceSide::kNotBelow, {});
            } else {
                add_common(walk_.polygon(i), walk_.common(i), facet);
            }
        }
    } else {
        clipper_.begin(outline);
        for (const std::int32_t polygon : candidates_)
            add_common(polygon, clipper_.intersect(outline_of(polygon)), facet);
    }
    assert(!plane.has_value() || may_stay || tile(scope_, pieces_, outline));
    return pieces_;
}

/// Whether a polygon of the tiling is nowhere below the facet where they meet, as far as heights
/// and floating point tell.
bool PieceFinder::is_higher(std::int32_t polygon, const EnvelopeFacet& facet) const {
    const PlaneId surface = tiling_.plane[static_cast<std::size_t>(polygon)];
    if (!surface.has_value() || !facet.plane.has_value()) return false;
    const HeightRange heights = tiling_.heights[static_cast<std::size_t>(polygon)];
    if (heights.low >= facet.heights.high) return true;
    if (heights.high < facet.heights.high) return false;  // most that are not higher
    const auto trace = scope_.shared().trace_filter(surface, facet.plane);
    return std::all_of(facet.outline.begin(), facet.outline.end(), [&](const Corner& corner) {
        return scope_.is_left_for_certain(trace, corner.point);
    });
}

/// Adds what a facet has in common with a polygon, which may be nothing.
void PieceFinder::add_common(std::int32_t polygon, PolygonView common, const EnvelopeFacet& facet) {
    if (common.empty()) return;
    const PlaneId surface = tiling_.plane[static_cast<std::size_t>(polygon)];
    if (!surface.has_value()) {
        add(polygon, PieceSide::kAbsent, common);
    } else if (!facet.plane.has_value()) {
        add(polygon, facet.plane == kSky ? PieceSide::kBelow : PieceSide::kNotBelow, common);
    } else {
        // both are pieces of triangles, so most are sorted by the heights of the corners
        const HeightRange heights = tiling_.heights[static_cast<std::size_t>(polygon)];
        if (heights.high < facet.heights.low) {
            add(polygon, PieceSide::kBelow, common);
        } else if (heights.low >= facet.heights.high) {
            add(polygon, PieceSide::kNotBelow, common);
            return;
        } else {
            classify(polygon, facet.plane, common);
        }
        note_room(surface, facet, heights, common);
    }
}

/// Notes whether there is room between the facet and a piece beneath it.
void PieceFinder::note_room(PlaneId surface, const EnvelopeFacet& facet, const HeightRange& heights,
                            PolygonView common) {
    const HeightRange& above = facet.heights;
    const double margin =
        scope_.shared().clear_height(std::max({std::abs(heights.low), std::abs(heights.high),
                                               std::abs(above.low), std::abs(above.high)}));
    if (!pieces_.is_clear || heights.high + margin < above.low) return;
    if (pieces_.list.back().side != PieceSide::kBelow) {
        pieces_.is_clear = false;
        return;
    }
    const auto trace = scope_.shared().trace_filter(surface, facet.plane);
    pieces_.is_clear = std::all_of(common.begin(), common.end(), [&](const Corner& corner) {
        return scope_.is_right_by(trace, corner.point, margin);
    });
}

void PieceFinder::classify(std::int32_t polygon, PlaneId facet_plane, PolygonView common) {
    const PlaneId surface = tiling_.plane[static_cast<std::size_t>(polygon)];
    if (surface == facet_plane) return add(polygon, PieceSide::kNotBelow, common);
    bool lower = false, higher = false;
    signs_.clear();
    const auto trace = scope_.shared().trace_filter(surface, facet_plane);
    for (const Corner& corner : common) {
        const int sign = scope_.compare_heights(surface, facet_plane, trace, corner.point);
        lower |= sign < 0;
        higher |= sign > 0;
        signs_.push_back(static_cast<std::int8_t>(sign));
    }
    if (!lower) return add(polygon, PieceSide::kNotBelow, common);
    const auto touches = [&](const Corner& corner) -> std::uint8_t {
        const auto at = std::ranges::find(common, corner.point, &Corner::point);
        return at == common.end() || signs_[static_cast<std::size_t>(at - common.begin())] == 0;
    };
    const auto add_below = [&](PolygonView below) {
        add(polygon, PieceSide::kBelow, below);
        std::ranges::transform(
            below, pieces_.touches.end() - static_cast<std::ptrdiff_t>(below.size()), touches);
    };
    if (!higher) return add_below(common);
    const DirectedLine above = scope_.trace(surface, facet_plane);
    opposite_.resize(signs_.size());
    std::ranges::transform(signs_, opposite_.begin(), std::negate<>());
    keep_left(scope_, common, above.reversed(), opposite_, half_);
    add_below(half_);
    keep_left(scope_, common, above, signs_, half_);
    add(polygon, PieceSide::kNotBelow, half_);
}

/// Adds a piece that touches the facet nowhere.
void PieceFinder::add(std::int32_t polygon, PieceSide side, PolygonView outline) {
    const auto first = static_cast<std::int64_t>(pieces_.corners.size());
    pieces_.corners.append(outline.begin(), outline.end());
    pieces_.touches.resize(pieces_.corners.size(), 0);
    pieces_.list.push_back(
        {polygon, side, first, static_cast<std::int64_t>(pieces_.corners.size())});
}

// Whether the cell goes through the edge that two pieces share: it is thick there and the surface
// has no step.
bool PieceGrouping::joined(const Pieces& pieces, const PieceEdge& a, const PieceEdge& b) {
    if (!a.below || !b.below || a.thin || b.thin) return false;
    const auto plane = [&](const PieceEdge& e) {
        const Piece& piece = pieces.list[static_cast<std::size_t>(e.piece)];
        return tiling_.plane[static_cast<std::size_t>(piece.polygon)];
    };
    return scope_.compare_heights(plane(a), plane(b), a.from) == 0 &&
           scope_.compare_heights(plane(a), plane(b), a.to) == 0;
}

bool PieceGrouping::on_border(PolygonView facet, const PieceEdge& edge) {
    return std::any_of(facet.begin(), facet.end(), [&](const Corner& corner) {
        return scope_.side(corner.line, edge.from) == 0 && scope_.side(corner.line, edge.to) == 0;
    });
}

void PieceGrouping::collect_edges(const Pieces& pieces) {
    edges_.clear();
    for (std::size_t i = 0; i < pieces.list.size(); ++i) {
        const Piece& piece = pieces.list[i];
        for (std::int64_t c = piece.first; c < piece.last; ++c) {
            const auto here = static_cast<std::size_t>(c);
            const auto next = static_cast<std::size_t>(c + 1 < piece.last ? c + 1 : piece.first);
            edges_.push_back({pieces.corners[here].point, pieces.corners[next].point,
                              static_cast<std::int32_t>(i), piece.side == PieceSide::kBelow,
                              pieces.touches[here] != 0 && pieces.touches[next] != 0});
        }
    }
    std::sort(edges_.begin(), edges_.end(), [](const PieceEdge& a, const PieceEdge& b) {
        return std::pair(a.key(), a.piece) < std::pair(b.key(), b.piece);
    });
}

std::int32_t PieceGrouping::group(PolygonView facet, const Pieces& pieces,
                                  std::vector<std::int32_t>& group) {
    const auto count = static_cast<std::int32_t>(pieces.list.size());
    group.assign(static_cast<std::size_t>(count), -1);
    DisjointSets cell_pieces(pieces.list.size());
    collect_edges(pieces);
    is_joined_.assign(edges_.size(), 0);
    for (std::size_t i = 0; i + 1 < edges_.size(); ++i) {
        const PieceEdge &a = edges_[i], &b = edges_[i + 1];
        if (a.key() != b.key() || !joined(pieces, a, b)) continue;
        is_joined_[i] = is_joined_[i + 1] = 1;
        cell_pieces.join(a.piece, b.piece);
    }
    // The border of a cell in plan must pass each point once, or the cell would touch itself in a
    // vertical edge; two of its pieces must not meet in an edge that does not join them; and where
    // an edge inside the facet has no partner (a long one faces two short ones) nothing is known.
    bool alone = false;
    border_.clear();
    for (std::size_t i = 0; i < edges_.size() && !alone; ++i) {
        const PieceEdge& edge = edges_[i];
        if (!edge.below || is_joined_[i] != 0) continue;
        border_.emplace_back(cell_pieces.find(edge.piece), edge.from);
        const bool before = i > 0 && edges_[i - 1].key() == edge.key();
        const bool after = i + 1 < edges_.size() && edges_[i + 1].key() == edge.key();
        if (!before && !after) {
            alone = !on_border(facet, edge);
        } else {
            const PieceEdge& partner = edges_[before ? i - 1 : i + 1];
            alone =
                partner.below && cell_pieces.find(partner.piece) == cell_pieces.find(edge.piece);
        }
    }
    std::sort(border_.begin(), border_.end());
    alone |= std::adjacent_find(border_.begin(), border_.end()) != border_.end();

    std::int32_t cells = 0;
    for (std::int32_t i = 0; i < count; ++i) {
        if (pieces.list[static_cast<std::size_t>(i)].side != PieceSide::kBelow) continue;
        auto& of_root = group[static_cast<std::size_t>(alone ? i : cell_pieces.find(i))];
        if (of_root < 0) of_root = cells++;
        group[static_cast<std::size_t>(i)] = of_root;
    }
    return cells;
}

}  // namespace realmodel::strata
