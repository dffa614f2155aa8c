// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/block_envelope.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Finds what of a surface lies beneath some positions.
class SheetLinks {
public:
    SheetLinks(PlanArrangement& geometry, const WholeTriangleFilter& filter,
               const BlockTiling& tiling, const CoveredFacets& covered, const Envelope& pieces,
               const Execution& execution)
        : geometry_(geometry),
          filter_(filter),
          tiling_(tiling),
          covered_(covered),
          pieces_(pieces),
          execution_(execution),
          scope_(geometry),
          clipper_(scope_) {}

    /// A covered facet, whose link is to be found.
    void add(std::int32_t node) {
        const auto i = static_cast<std::size_t>(node - covered_.first_node);
        const auto point = [&](const Corner& corner) -> const exact::Point& {
            return geometry_.point(corner.point);
        };
        const auto middle =
            i < covered_.wholes.size()
                ? middle_of(geometry_, covered_.wholes[i])
                : middle_of(pieces_.outlines[covered_.pieces[i - covered_.wholes.size()]], point);
        searched_.push_back({middle, node, kNothing});
    }

    /// Calls link(node, triangle) with what lies beneath each facet.
    template <class Link>
    void find(const Link& link) {
        if (searched_.empty()) return;
        const spatial::PointBins middles(transformed(searched_, &Searched::middle));
        // The middle of a convex outline is inside it, so a triangle that it is in for certain
        // shares an area with the outline. The exact test is for the few middles near an edge.
        const auto near = collect_items<std::pair<std::size_t, std::int32_t>>(
            tiling_.whole.size(), execution_, [&](std::size_t t, auto& pairs) {
                if (filter_.surface[t] != HeightRelation::kBelow) return;
                const PlanTriangle& triangle = geometry_.plane(tiling_.whole[t]).plan;
                const auto number = static_cast<std::int32_t>(t);
                middles.within(filter_.surface_at[t].bounds.box,
                               [&](std::size_t s, const spatial::PlanPosition& middle) {
                                   const int side = side_of_border(geometry_, triangle, middle);
                                   if (side == 0) pairs.emplace_back(s, number);
                                   // a position is well inside one triangle at the most
                                   if (side > 0) searched_[s].beneath = number;
                               });
            });
        for (const auto& [s, t] : near) {
            if (searched_[s].beneath == kNothing && lies_over(searched_[s].node, t))
                searched_[s].beneath = t;
        }
        const auto triangles = static_cast<std::int32_t>(tiling_.whole.size());
        for (Searched& s : searched_) {
            // where rounding put a middle beside the boxes of all that lie beneath it
            for (std::int32_t t = 0; t < triangles && s.beneath == kNothing; ++t) {
                if (filter_.surface[static_cast<std::size_t>(t)] == HeightRelation::kBelow &&
                    lies_over(s.node, t))
                    s.beneath = t;
            }
            if (s.beneath == kNothing) refuse(s);
            link(s.node, s.beneath);
        }
    }

private:
    static constexpr std::int32_t kNothing = -1;
    struct Searched {
        std::array<double, 2> middle;
        std::int32_t node;
        std::int32_t beneath;  ///< a triangle of the surface that lies there
    };

    [[noreturn]] void refuse(const Searched& s) const {
        const auto i = static_cast<std::size_t>(s.node - covered_.first_node);
        const PlaneId plane = i < covered_.wholes.size()
                                  ? covered_.wholes[i]
                                  : pieces_.plane[covered_.pieces[i - covered_.wholes.size()]];
        throw InternalError(
            "a triangle of the surface lies beneath each facet that it is sorted below",
            std::array{s.middle[0], s.middle[1], heights_of(geometry_, plane).low});
    }
    bool lies_over(std::int32_t node, std::int32_t triangle) {
        const auto outline_of = [&](PlaneId plane) {
            return triangle_outline(geometry_, geometry_.plane(plane).plan);
        };
        const auto below = outline_of(tiling_.whole[static_cast<std::size_t>(triangle)]);
        clipper_.begin(below);
        const auto i = static_cast<std::size_t>(node - covered_.first_node);
        if (i < covered_.wholes.size()) return clipper_.overlaps(outline_of(covered_.wholes[i]));
        return clipper_.overlaps(pieces_.outlines[covered_.pieces[i - covered_.wholes.size()]]);
    }

    PlanArrangement& geometry_;
    const WholeTriangleFilter& filter_;
    const BlockTiling& tiling_;
    const CoveredFacets& covered_;
    const Envelope& pieces_;
    Execution execution_;
    LocalArrangement scope_;
    Clipper clipper_;
    std::vector<Searched> searched_;
};

/// Joins covered triangles that are neighbors over one block.
void join_neighbors(const TriangleLinks& links, const CoveredFacets& covered,
                    const WholeTriangles& wholes, const Construction& construction,
                    DisjointSets& sets, const Execution& execution) {
    const auto count = static_cast<std::int32_t>(covered.wholes.size());
    const auto block = [&](std::int32_t node) {
        return construction.node_block[static_cast<std::size_t>(node)];
    };
    parallel_for_each(covered.wholes.size(), execution, [&](std::size_t i) {
        const PlaneId plane = covered.wholes[i];
        const std::int32_t node = covered.first_node + static_cast<std::int32_t>(i);
        for (const PlaneId other : links.of(plane)) {
            if (other <= plane) continue;
            const std::int32_t below = wholes.of(other).below;
            const std::int32_t j = below - covered.first_node;
            if (j >= 0 && j < count && block(below) == block(node))
                sets.join(static_cast<std::int32_t>(i), j);
        }
    });
}

/// Links covered facets with the surface beneath them, which they were never overlaid with.
/// Neighboring triangles of facets are connected, and so are the triangles beneath them: one link
/// for each connected component of them is enough.
/// @param filter  which compared `tiling` with the facets
/// @param node_above  of each triangle of the tiling that is below
void link_sheets(PlanArrangement& geometry, const TriangleLinks& links,
                 const WholeTriangleFilter& filter, const BlockTiling& tiling,
                 const std::vector<std::int32_t>& node_above, const CoveredFacets& covered,
                 const Envelope& pieces, const WholeTriangles& wholes, Construction& construction,
                 const Execution& execution) {
    const std::size_t count = covered.wholes.size();
    DisjointSets sets(count);
    join_neighbors(links, covered, wholes, construction, sets, execution);
    SheetLinks sheets(geometry, filter, tiling, covered, pieces, execution);
    for (std::size_t i = 0; i < count + covered.pieces.size(); ++i) {
        const auto k = static_cast<std::int32_t>(i);
        if (i >= count || sets.find(k) == k) sheets.add(covered.first_node + k);
    }
    sheets.find([&](std::int32_t node, std::int32_t triangle) {
        construction.links.emplace_back(node, node_above[static_cast<std::size_t>(triangle)]);
    });
}

}  // namespace

BlockEnvelope::BlockEnvelope(PlanArrangement& geometry, const TriangleLinks& links,
                             const BorderEdges& borders, double largest_height,
                             Construction& construction, WholeTriangles& wholes,
                             const Execution& execution)
    : geometry_(geometry),
      links_(links),
      borders_(borders),
      construction_(construction),
      wholes_(wholes),
      execution_(execution),
      filter_(geometry, borders, largest_height, execution),
      cover_(tiles().size(), Cover::kFacets) {}

void BlockEnvelope::add_sky(const PlanTriangle& triangle, PlaneId plane, Cover cover) {
    pieces_.add_facet(triangle_outline(geometry_, triangle), plane, -1, kSkyBlock);
    cover_tiles(triangle, cover);
}

void BlockEnvelope::cover_tiles(const PlanTriangle& triangle, Cover cover) {
    tiles().for_each_center_in(corners_of(geometry_, triangle),
                               [&](std::size_t tile) { cover_[tile] = cover; });
}

void BlockEnvelope::start_region(const FrameTriangles& filling) {
    is_started_ = true;
    for (const bool inside : {true, false}) {
        for (std::size_t t = 0; t < filling.triangles.size(); ++t) {
            if ((filling.covered[t] != 0) != inside) continue;
            add_sky(filling.triangles[t], inside ? kSky : kOutside,
                    inside ? Cover::kSkyOnly : Cover::kNothing);
        }
    }
}

void BlockEnvelope::start_window(const FrameTriangles& region, const FrameTriangles& window,
                                 Envelope pieces) {
    is_started_ = true;
    pieces_ = std::move(pieces);
    std::fill(cover_.begin(), cover_.end(), Cover::kSkyOnly);
    for (const FrameTriangles* filling : {&region, &window}) {
        for (std::size_t t = 0; t < filling->triangles.size(); ++t) {
            if (filling->covered[t] == 0) cover_tiles(filling->triangles[t], Cover::kNothing);
        }
    }
}

void BlockEnvelope::start(const BlockTiling& tiling, std::int32_t number) {
    is_started_ = true;
    for (const PlanTriangle& t : tiling.empty)
        add_sky(t, kSky, Cover::kSkyOnly);
    for (std::size_t t = 0; t < tiling.whole.size(); ++t) {
        poll(execution_.progress, t);
        enter(tiling.whole[t], number, kOutsideCell,
              tiles().span(bounds_of(geometry_, tiling.whole[t]).box));
    }
    std::swap(whole_, next_whole_);
    std::swap(whole_block_, next_whole_block_);
    for (std::size_t p = 0; p < tiling.piece_plane.size(); ++p) {
        const PlaneId plane = tiling.piece_plane[p];
        wholes_.piece_state[index(plane)] = PieceState::kInPieces;
        pieces_.add_facet(tiling.pieces[p], plane, number, number);
        pieces_.add_face(tiling.pieces[p], kOutsideCell);
    }
}

/// Makes a whole triangle of a surface a facet.
void BlockEnvelope::enter(PlaneId plane, std::int32_t number, std::int32_t node_above,
                          const TileSpan& span) {
    assert(!wholes_.of(plane).is_set());
    wholes_.of(plane) = {node_above, WholeFace::kUnset, number};
    if (borders_.near(span)) wholes_.is_exact[index(plane)] = 1;
    next_whole_.push_back(plane);
    next_whole_block_.push_back(number);
}

Overlaid BlockEnvelope::overlay_exactly(const FacetView& facets, const SurfaceTiling& exact_tiling,
                                        std::int32_t number) {
    const std::vector<std::size_t> exact = filter_.exact_facets();
    const auto first_piece = static_cast<std::size_t>(
        std::lower_bound(exact.begin(), exact.end(), whole_.size()) - exact.begin());
    PolygonPool outlines;
    add_outlines(
        geometry_, first_piece,
        [&](std::size_t i) { return geometry_.plane(whole_[exact[i]]).plan; }, outlines,
        execution_.progress);
    Envelope envelope;
    BlockFacets blocks{&borders_, {}, std::vector<std::uint8_t>(exact.size(), 1)};
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const std::size_t f = exact[i];
        blocks.span.push_back(filter_.facet_at[f].span);
        if (i < first_piece) {
            const WholeFace& face = wholes_.of(whole_[f]);
            wholes_.is_exact[index(whole_[f])] = 1;
            // until it turns out to be kept or sealed as it is
            wholes_.piece_state[index(whole_[f])] = PieceState::kMayStayWhole;
            envelope.add_facet(outlines[i], whole_[f], face.surface, whole_block_[f]);
            envelope.add_face(outlines[i], face.above);
            continue;
        }
        envelope.add_facet_of(pieces_, f - whole_.size(), facets.block(f));
        if (!facets.plane(f).has_value()) {
            blocks.is_complete[i] = !tiles().any(filter_.facet_at[f].span, [&](std::size_t tile) {
                return !borders_.in_tile(tile) && filter_.is_empty[tile] == 0;
            });
        }
    }
    const std::size_t first_face = construction_.faces.size();
    Overlaid overlaid = overlay_facets(geometry_, envelope, {exact_tiling, number}, &blocks,
                                       nullptr, construction_, execution_);
    sort_overlaid(overlaid.remaining, first_face);
    for (std::size_t i = 0; i < first_piece; ++i) {
        PieceState& state = wholes_.piece_state[index(whole_[exact[i]])];
        state = state == PieceState::kMayStayWhole ? PieceState::kInPieces : PieceState::kWhole;
    }
    return overlaid;
}

/// Whether a polygon in the plane of a triangle is all of it.
bool BlockEnvelope::is_triangle(PolygonView polygon, PlaneId plane) const {
    const PlanTriangle& corner = geometry_.plane(plane).plan;
    return polygon.size() == 3 && polygon[0].point == corner[0] && polygon[1].point == corner[1] &&
           polygon[2].point == corner[2];
}

/// Of what facets overlaid exactly became, whole triangles stay or become whole faces.
void BlockEnvelope::sort_overlaid(const Envelope& remaining, std::size_t first_face) {
    const auto stays_whole = [&](PolygonView polygon, PlaneId plane) {
        if (!plane.has_value()) return false;
        PieceState& state = wholes_.piece_state[index(plane)];
        if (state != PieceState::kMayStayWhole || !is_triangle(polygon, plane)) return false;
        state = PieceState::kStaysWhole;
        return true;
    };
    const FaceList& faces = construction_.faces;
    for (std::size_t f = first_face; f < faces.size(); ++f) {
        // where a border or a touch divides what is beneath, the triangle is in pieces all the same
        if (construction_.node_is_thick[static_cast<std::size_t>(faces.below[f])] == 0 ||
            !stays_whole(faces.polygons[f], faces.plane[f]))
            continue;
        wholes_.of(faces.plane[f]).below = faces.below[f];
        wholes_.is_added[index(faces.plane[f])] = 1;
    }
    for (std::size_t f = 0; f < remaining.size(); ++f) {
        if (stays_whole(remaining.outlines[f], remaining.plane[f])) {
            next_whole_.push_back(remaining.plane[f]);
            next_whole_block_.push_back(remaining.block_beneath[f]);
        } else {
            next_pieces_.add_facet_of(remaining, f, remaining.block_beneath[f]);
        }
    }
}

/// Facets that bounds sorted.
CoveredFacets BlockEnvelope::sort_facets(std::int32_t number) {
    CoveredFacets covered;
    covered.first_node = static_cast<std::int32_t>(construction_.node_block.size());
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        const HeightRelation relation = filter_.facet[f];
        if (relation == HeightRelation::kAbove) {
            wholes_.of(whole_[f]).below = construction_.add_node(whole_block_[f], true);
            covered.wholes.push_back(whole_[f]);
        } else if (relation != HeightRelation::kExact) {
            next_whole_.push_back(whole_[f]);
            next_whole_block_.push_back(relation == HeightRelation::kBelow ? number
                                                                           : whole_block_[f]);
        }
    }
    for (std::size_t f = 0; f < pieces_.size(); ++f) {
        const HeightRelation relation = filter_.facet[whole_.size() + f];
        if (relation == HeightRelation::kAbove) {
            construction_.seal(pieces_, f, construction_.add_node(pieces_.block_beneath[f], true));
            covered.pieces.push_back(f);
        } else if (relation != HeightRelation::kExact) {
            next_pieces_.add_facet_of(
                pieces_, f, relation == HeightRelation::kBelow ? number : pieces_.block_beneath[f]);
        }
    }
    return covered;
}

/// Of each triangle in the exact tiling, whether it stays whole: it touches the facets nowhere, has
/// one block above it, and no border divides it. Walls end on divided ones.
std::vector<std::uint8_t> BlockEnvelope::find_whole(const SurfaceTiling& exact_tiling,
                                                    const PiecesOfPolygons& pieces,
                                                    const Overlaid& overlaid,
                                                    std::size_t triangles) const {
    constexpr std::size_t kPolygons = 1 << 10;
    const auto block_above = [&](std::uint32_t piece) {
        const std::int32_t node = overlaid.below.node_above[piece];
        return node < 0 ? kSkyBlock : construction_.node_block[static_cast<std::size_t>(node)];
    };
    std::vector<std::uint8_t> is_whole(exact_tiling.plane.size(), 0);
    parallel_ranges(triangles, kPolygons, execution_, [&](std::size_t begin, std::size_t end) {
        LocalArrangement scope(geometry_);
        for (std::size_t t = begin; t < end; ++t) {
            if (filter_.polygon[t] < 0) continue;
            const auto p = static_cast<std::size_t>(filter_.polygon[t]);
            const auto below = pieces[p];
            if (below.empty() || overlaid.is_divided[p] != 0 || overlaid.is_touched[p] != 0)
                continue;
            const bool alike = std::all_of(below.begin(), below.end(), [&](std::uint32_t i) {
                return block_above(i) == block_above(below.front());
            });
            is_whole[p] = alike && !borders_.divide(scope, exact_tiling.polygons[p],
                                                    filter_.surface_at[t].span);
        }
    });
    return is_whole;
}

/// The surface's own facets.
void BlockEnvelope::add_surface(const BlockTiling& tiling, const SurfaceTiling& exact_tiling,
                                std::int32_t number, Overlaid& overlaid) {
    const std::size_t triangles = tiling.whole.size();
    const PiecesOfPolygons pieces =
        sort_by_polygon(overlaid.below, exact_tiling.plane.size(), execution_);
    const auto is_whole = find_whole(exact_tiling, pieces, overlaid, triangles);
    const auto node_of = [&](std::uint32_t piece) { return overlaid.below.node_above[piece]; };
    const auto link = [&](std::int32_t a, std::int32_t b) {
        if (a >= 0 && b >= 0 && a != b) construction_.links.emplace_back(a, b);
    };
    node_above_.assign(triangles, kOutsideCell);
    std::vector<std::uint8_t>& use = overlaid.is_divided;
    for (std::size_t t = 0; t < tiling.size(); ++t) {
        const HeightRelation relation = filter_.surface[t];
        const PlaneId plane = tiling.plane(t);
        if (relation == HeightRelation::kBelow) {
            if (filter_.block[t] != kSkyBlock)
                node_above_[t] = construction_.add_node(filter_.block[t], true);
            enter(plane, number, node_above_[t], filter_.surface_at[t].span);
        }
        if (filter_.polygon[t] < 0) continue;
        const auto p = static_cast<std::size_t>(filter_.polygon[t]);
        const auto below = pieces[p];
        if (relation != HeightRelation::kExact || below.empty()) {
            use[p] = kElsewhere;
            if (relation == HeightRelation::kAbove) continue;
            for (const std::uint32_t piece : below)
                link(node_above_[t], node_of(piece));
            continue;
        }
        wholes_.is_exact[index(plane)] = 1;
        if (is_whole[p] == 0) {
            wholes_.piece_state[index(plane)] = PieceState::kInPieces;
            continue;
        }
        use[p] = kElsewhere;
        for (const std::uint32_t piece : below)
            link(node_of(below.front()), node_of(piece));
        enter(plane, number, node_of(below.front()), filter_.surface_at[t].span);
    }
    add_surface_facets({exact_tiling, number}, use, overlaid.below, pieces, next_pieces_,
                       execution_);
}

void BlockEnvelope::add(const BlockTiling& tiling, std::int32_t number) {
    if (!is_started_) {
        start(tiling, number);
        return;
    }
    const FacetView facets = view();
    filter_.begin(tiling);
    filter_.compare(facets);
    next_whole_.clear();
    next_whole_block_.clear();
    next_pieces_ = {};
    const SurfaceTiling exact_tiling = filter_.make_exact_tiling(geometry_, facets);
    Overlaid overlaid = overlay_exactly(facets, exact_tiling, number);
    const CoveredFacets covered = sort_facets(number);
    add_surface(tiling, exact_tiling, number, overlaid);
    link_sheets(geometry_, links_, filter_, tiling, node_above_, covered, pieces_, wholes_,
                construction_, execution_);
    for (std::size_t tile = 0; tile < cover_.size(); ++tile) {
        if (cover_[tile] == Cover::kSkyOnly && filter_.is_empty[tile] == 0)
            cover_[tile] = Cover::kFacets;
    }
    std::swap(whole_, next_whole_);
    std::swap(whole_block_, next_whole_block_);
    std::swap(pieces_, next_pieces_);
}

void BlockEnvelope::finish(std::optional<PlaneId> base) {
    for (std::size_t f = 0; f < whole_.size(); ++f) {
        std::int32_t node = kOutsideCell;
        if (base && whole_block_[f] == 0) {
            node = construction_.add_node(0, true);
            wholes_.on_base.push_back({whole_[f], *base, node});
        }
        wholes_.of(whole_[f]).below = node;
    }
    strata::finish(pieces_, base, true, construction_);
    whole_ = next_whole_ = {};
    pieces_ = next_pieces_ = {};
}

std::array<double, 3> BlockEnvelope::lowest() const {
    std::array<double, 3> lowest = lowest_position(geometry_, pieces_);
    for (const PlaneId plane : whole_) {
        for (const exact::SpaceId s : geometry_.plane(plane).corner) {
            const auto& vertex = geometry_.space(s);
            const auto& at = geometry_.point(vertex.plan);
            if (vertex.z < lowest[2]) lowest = {at.x, at.y, vertex.z};
        }
    }
    return lowest;
}

}  // namespace realmodel::strata
