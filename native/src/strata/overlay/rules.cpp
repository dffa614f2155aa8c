// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/rules.hpp"

#include <algorithm>
#include <cassert>
#include <memory>

#include "base/parallel_counts.hpp"
#include "strata/overlay/pieces.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kFacetsAtOnce = 256;

/// Convex facets found by one chunk, in its own ids or shared ones.
struct ChunkFacets {
    explicit ChunkFacets(const PlanArrangement& geometry) : scope(geometry) {}

    void add(PolygonView outline, PlaneId in_plane, std::int32_t of_polygon = -1) {
        outlines.add(outline);
        plane.push_back(in_plane);
        polygon.push_back(of_polygon);
    }

    LocalArrangement scope;
    PolygonPool outlines;
    std::vector<PlaneId> plane;
    std::vector<std::int32_t>
        polygon;  ///< of the surface that was laid over, -1 for the older tiling
};

using FacetChunks = std::vector<std::unique_ptr<ChunkFacets>>;

/// Calls work(facet of `older`, finder, found) for every facet, in parallel; results in order.
template <class Work>
FacetChunks over_facets(PlanArrangement& geometry, const SurfaceTiling& older,
                        const SurfaceTiling& surface, const Execution& execution,
                        const Work& work) {
    const std::size_t count = older.plane.size(),
                      chunks = (count + kFacetsAtOnce - 1) / kFacetsAtOnce;
    FacetChunks facets(chunks);
    parallel_chunks(chunks, execution, [&](std::size_t c) {
        facets[c] = std::make_unique<ChunkFacets>(geometry);
        PieceFinder finder(facets[c]->scope, surface);
        for (std::size_t f = c * kFacetsAtOnce; f < std::min(count, (c + 1) * kFacetsAtOnce); ++f) {
            work(f, finder, *facets[c]);
        }
    });
    for (auto& chunk : facets)
        chunk->scope.commit(geometry);
    return facets;
}

/// Adds those facets found of which is_wanted(polygon) holds, in shared ids.
template <class IsWanted>
void append(const FacetChunks& facets, SurfaceTiling& tiling, const IsWanted& is_wanted) {
    for (const auto& chunk : facets) {
        for (std::size_t i = 0; i < chunk->plane.size(); ++i) {
            if (!is_wanted(chunk->polygon[i])) continue;
            Polygon outline(chunk->outlines[i].begin(), chunk->outlines[i].end());
            for (Corner& corner : outline)
                corner = {chunk->scope.shared_point(corner.point),
                          chunk->scope.shared_directed(corner.line)};
            tiling.polygons.add(outline);
            tiling.plane.push_back(chunk->plane[i]);
        }
    }
}
SurfaceTiling tiling_of(const FacetChunks& facets) {
    SurfaceTiling tiling;
    append(facets, tiling, [](std::int32_t) { return true; });
    return tiling;
}

}  // namespace

SurfaceTiling raise_tiling(PlanArrangement& geometry, const SurfaceTiling& surface,
                           const SurfaceTiling& bound, std::span<const std::uint8_t> excluded,
                           const Execution& execution) {
    assert(excluded.empty() || excluded.size() == surface.plane.size());
    const auto is_excluded = [&](std::size_t p) { return !excluded.empty() && excluded[p] != 0; };
    std::vector<std::uint8_t> is_covered(surface.plane.size(), 0);  // somewhere, by the bound
    const auto facets = over_facets(
        geometry, bound, surface, execution,
        [&](std::size_t f, PieceFinder& finder, ChunkFacets& out) {
            const PlaneId plane = bound.plane[f];
            const Pieces& pieces = finder.find(bound.polygons[f], plane);
            const bool all_below =
                plane.has_value() &&
                std::all_of(pieces.list.begin(), pieces.list.end(),
                            [](const Piece& p) { return p.side == PieceSide::kBelow; });
            if (all_below) out.add(bound.polygons[f], plane);
            for (const Piece& piece : pieces.list) {
                const auto polygon = static_cast<std::size_t>(piece.polygon);
                if (piece.side == PieceSide::kBelow) {
                    atomic_set(is_covered[polygon]);
                    if (!all_below) out.add(pieces.outline(piece), plane);
                } else if (piece.side == PieceSide::kNotBelow) {
                    out.add(pieces.outline(piece), surface.plane[polygon], piece.polygon);
                }
            }
        });
    SurfaceTiling raised;
    for (std::size_t p = 0; p < surface.plane.size(); ++p) {
        if (is_excluded(p) || (surface.plane[p].has_value() && is_covered[p] != 0)) continue;
        raised.polygons.add(surface.polygons[p]);
        raised.plane.push_back(surface.plane[p]);
    }
    append(facets, raised, [&](std::int32_t polygon) {
        return polygon < 0 || (is_covered[index(polygon)] != 0 && !is_excluded(index(polygon)));
    });
    return raised;
}

SurfaceTiling uncovered_tiling(PlanArrangement& geometry, const SurfaceTiling& older,
                               const SurfaceTiling& surface, const Execution& execution) {
    const auto is_absent = [](const Piece& piece) { return piece.side == PieceSide::kAbsent; };
    const auto look = [&](std::size_t f, PieceFinder& finder, ChunkFacets& out) {
        // as a void, so that heights are not asked for
        const Pieces& pieces = finder.find(older.polygons[f], kVoid);
        if (std::ranges::all_of(pieces.list, is_absent)) {
            out.add(older.polygons[f], older.plane[f]);
            return;
        }
        for (const Piece& piece : pieces.list) {
            if (is_absent(piece)) out.add(pieces.outline(piece), older.plane[f]);
        }
    };
    return tiling_of(over_facets(geometry, older, surface, execution, look));
}

SurfaceTiling lower_tiling(PlanArrangement& geometry, const SurfaceTiling& one, SurfaceTiling other,
                           const Execution& execution) {
    other.index(geometry, execution);
    return tiling_of(over_facets(
        geometry, one, other, execution, [&](std::size_t f, PieceFinder& finder, ChunkFacets& out) {
            const PlaneId plane = one.plane[f];
            if (!plane.has_value()) {
                out.add(one.polygons[f], kVoid);
                return;
            }
            const Pieces& pieces = finder.find(one.polygons[f], plane);
            for (const Piece& piece : pieces.list) {
                const PlaneId below = other.plane[static_cast<std::size_t>(piece.polygon)];
                out.add(pieces.outline(piece), piece.side == PieceSide::kNotBelow ? plane : below);
            }
        }));
}

SurfaceTiling lowest_tiling(PlanArrangement& geometry, const SurfaceTiling& one,
                            const SurfaceTiling& other, bool fills, const Execution& execution) {
    return tiling_of(over_facets(
        geometry, one, other, execution, [&](std::size_t f, PieceFinder& finder, ChunkFacets& out) {
            const PlaneId plane = one.plane[f];
            if (plane == kSky || (plane.has_value() && fills)) {
                out.add(one.polygons[f], plane);
                return;
            }
            // beneath a void nothing is below: what there is lies where `one` is not
            const Pieces& pieces = finder.find(one.polygons[f], plane);
            const PieceSide changed = plane.has_value() ? PieceSide::kBelow : PieceSide::kNotBelow;
            if (std::none_of(pieces.list.begin(), pieces.list.end(),
                             [&](const Piece& p) { return p.side == changed; })) {
                out.add(one.polygons[f], plane);
                return;
            }
            for (const Piece& piece : pieces.list) {
                const PlaneId in_other = other.plane[static_cast<std::size_t>(piece.polygon)];
                out.add(pieces.outline(piece),
                        piece.side != changed ? plane : (fills ? kSky : in_other));
            }
        }));
}

SurfaceTiling TilingRaising::raise(const SurfaceTiling& surface, const SurfaceTiling& bound) const {
    SurfaceTiling raised = raise_tiling(geometry_, surface, bound, {}, execution_);
    raised.index(geometry_, execution_);
    raised.link(geometry_, execution_.progress);
    return raised;
}

SurfaceTiling TilingRaising::cover(const SurfaceTiling& older, const SurfaceTiling& newer,
                                   const SurfaceTiling& surface) const {
    const SurfaceTiling rest = uncovered_tiling(geometry_, older, surface, execution_);
    SurfaceTiling covered;
    for (const SurfaceTiling* tiling : {&newer, &rest}) {
        for (std::size_t p = 0; p < tiling->plane.size(); ++p) {
            if (tiling == &newer && !tiling->plane[p].has_value()) continue;
            covered.polygons.add(tiling->polygons[p]);
            covered.plane.push_back(tiling->plane[p]);
        }
    }
    return covered;
}

SurfaceTiling TilingRaising::lowest(const std::optional<SurfaceTiling>& so_far,
                                    const SurfaceTiling& e, bool fills) const {
    if (so_far) return lowest_tiling(geometry_, *so_far, e, fills, execution_);
    SurfaceTiling lowest = e;
    if (fills) std::ranges::replace_if(lowest.plane, &PlaneId::has_value, kSky);
    return lowest;
}

SurfaceTiling TilingRaising::stays(SurfaceTiling lowest) const {
    std::ranges::replace(lowest.plane, kSky, kVoid);
    lowest.index(geometry_, execution_);
    return lowest;
}

namespace {

/// Adds the facets of a bound that the filter found to be in one relation.
void add_facets_that_are(const BlockTiling& bound, const std::vector<HeightRelation>& relation,
                         HeightRelation wanted, BlockTiling& to) {
    for (std::size_t f = 0; f < bound.size(); ++f) {
        if (relation[f] != wanted) continue;
        if (bound.is_whole(f)) {
            to.whole.push_back(bound.whole[f]);
        } else {
            to.add_piece(bound.pieces[f - bound.whole.size()], bound.plane(f));
        }
    }
}

}  // namespace

/// The exact facets of a bound, in outlines of their own.
SurfaceTiling BlockRaising::exact_facets(const BlockTiling& bound) {
    SurfaceTiling exact;
    const std::vector<std::size_t> numbers = filter_.exact_facets();
    for (const std::size_t f : numbers)
        exact.plane.push_back(bound.plane(f));
    const auto wholes = static_cast<std::size_t>(
        std::lower_bound(numbers.begin(), numbers.end(), bound.whole.size()) - numbers.begin());
    add_outlines(
        geometry_, wholes, [&](std::size_t i) { return geometry_.plane(exact.plane[i]).plan; },
        exact.polygons, execution_.progress);
    for (std::size_t i = wholes; i < numbers.size(); ++i)
        exact.polygons.add(bound.pieces[numbers[i] - bound.whole.size()]);
    return exact;
}

BlockTiling BlockRaising::raise(const BlockTiling& surface, const BlockBound& bound) {
    const FacetView facets = view(bound);
    filter_.compare(facets);
    const SurfaceTiling exact_tiling = filter_.make_exact_tiling(geometry_, facets);
    BlockTiling raised;
    raised.is_raised = true;
    raised.empty = surface.empty;
    std::vector<std::uint8_t> excluded(exact_tiling.plane.size(), 0);
    for (std::size_t t = 0; t < surface.whole.size(); ++t) {
        if (filter_.surface[t] == HeightRelation::kAbove) raised.whole.push_back(surface.whole[t]);
        if (filter_.surface[t] != HeightRelation::kExact && filter_.polygon[t] >= 0)
            excluded[static_cast<std::size_t>(filter_.polygon[t])] = 1;
    }
    add_facets_that_are(bound.tiling, filter_.facet, HeightRelation::kAbove, raised);
    const SurfaceTiling exact =
        raise_tiling(geometry_, exact_tiling, exact_facets(bound.tiling), excluded, execution_);
    for (std::size_t p = 0; p < exact.plane.size(); ++p) {
        if (exact.plane[p].has_value()) raised.add_piece(exact.polygons[p], exact.plane[p]);
    }
    return raised;
}

BlockBound BlockRaising::first(const BlockTiling& e) {
    BlockBound bound{e, std::vector<Cover>(filter_.tiles().size(), Cover::kFacets)};
    for (const PlanTriangle& t : e.empty)
        bound.tiling.add_piece(triangle_outline(geometry_, t), kVoid);
    bound.tiling.empty.clear();
    filter_.cover(view(bound));
    for (std::size_t tile = 0; tile < bound.cover.size(); ++tile) {
        if (filter_.is_empty[tile] != 0) bound.cover[tile] = Cover::kNothing;
    }
    return bound;
}

BlockBound BlockRaising::cover(const BlockBound& older, const BlockTiling& newer,
                               const BlockTiling& /* the one begun with */) {
    const FacetView facets = view(older);
    filter_.cover(facets);
    const SurfaceTiling exact_tiling = filter_.make_exact_tiling(geometry_, facets, true);
    BlockBound covered{newer, older.cover};
    covered.tiling.empty.clear();
    add_facets_that_are(older.tiling, filter_.facet, HeightRelation::kUncovered, covered.tiling);
    const SurfaceTiling rest =
        uncovered_tiling(geometry_, exact_facets(older.tiling), exact_tiling, execution_);
    for (std::size_t p = 0; p < rest.plane.size(); ++p)
        covered.tiling.add_piece(rest.polygons[p], rest.plane[p]);
    for (std::size_t tile = 0; tile < covered.cover.size(); ++tile) {
        if (filter_.is_empty[tile] == 0) covered.cover[tile] = Cover::kFacets;
    }
    return covered;
}

}  // namespace realmodel::strata
