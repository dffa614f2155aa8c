// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/block_raising.hpp"

#include "strata/tiling/triangle_outlines.hpp"

namespace realmodel::strata {

namespace {

/// Adds the facets of a bound that the filter found to be in a given standing.
void add_standing(const BlockTiling& bound, const std::vector<Standing>& standing, Standing wanted,
                  BlockTiling& to) {
    for (std::size_t f = 0; f < bound.size(); ++f) {
        if (standing[f] != wanted) continue;
        if (bound.is_whole(f)) {
            to.whole.push_back(bound.whole[f]);
        } else {
            to.add_part(bound.parts[f - bound.whole.size()], bound.plane(f));
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
        exact.polygons.add(bound.parts[numbers[i] - bound.whole.size()]);
    return exact;
}

BlockTiling BlockRaising::raise(const BlockTiling& surface, const BlockBound& bound) {
    const FacetView facets = view(bound);
    filter_.compare(facets);
    const SurfaceTiling part = filter_.exact_part(geometry_, links_, facets);
    BlockTiling raised;
    raised.is_raised = true;
    raised.empty = surface.empty;
    std::vector<std::uint8_t> given(part.plane.size(), 0);
    for (std::size_t t = 0; t < surface.whole.size(); ++t) {
        if (filter_.surface[t] == Standing::kAbove) raised.whole.push_back(surface.whole[t]);
        if (filter_.surface[t] != Standing::kExact && filter_.polygon[t] >= 0)
            given[static_cast<std::size_t>(filter_.polygon[t])] = 1;
    }
    add_standing(bound.tiling, filter_.facet, Standing::kAbove, raised);
    const SurfaceTiling exact =
        raise_tiling(geometry_, part, exact_facets(bound.tiling), given, execution_);
    for (std::size_t p = 0; p < exact.plane.size(); ++p) {
        if (exact.plane[p].has_value()) raised.add_part(exact.polygons[p], exact.plane[p]);
    }
    return raised;
}

BlockBound BlockRaising::first(const BlockTiling& e) {
    BlockBound bound{e, std::vector<Cover>(filter_.tiles().size(), Cover::kFacets)};
    for (const PlanTriangle& t : e.empty)
        bound.tiling.add_part(triangle_outline(geometry_, t), kVoid);
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
    const SurfaceTiling part = filter_.exact_part(geometry_, links_, facets, true);
    BlockBound covered{newer, older.cover};
    covered.tiling.empty.clear();
    add_standing(older.tiling, filter_.facet, Standing::kUncovered, covered.tiling);
    const SurfaceTiling rest =
        uncovered_part(geometry_, exact_facets(older.tiling), part, execution_);
    for (std::size_t p = 0; p < rest.plane.size(); ++p)
        covered.tiling.add_part(rest.polygons[p], rest.plane[p]);
    for (std::size_t tile = 0; tile < covered.cover.size(); ++tile) {
        if (filter_.is_empty[tile] == 0) covered.cover[tile] = Cover::kFacets;
    }
    return covered;
}

}  // namespace realmodel::strata
