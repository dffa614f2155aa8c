// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "spatial/tile_bins.hpp"
#include "strata/overlay/border_edges.hpp"
#include "strata/overlay/triangle_comparison.hpp"
#include "strata/tiling/block_tiling.hpp"

namespace realmodel::strata {

/// Bounds, and the tiles that the box meets.
struct TileBounds {
    TriangleBounds bounds;
    TileSpan span;
};

/// What there is all over a tile that no border crosses: facets, the sky above all, nothing.
enum class Cover : std::uint8_t { kFacets, kSkyOnly, kNothing };

/// Instead of a block: not known beside a border, none yet, several, the outside, the sky.
inline constexpr std::int32_t kBesideBorder = -5, kNoBlock = -4, kSeveral = -3, kOutsideBlock = -2,
                              kSkyBlock = -1;

/// Between which heights things lie in a tile, and which block is beneath them.
struct TileContent {
    double low = HUGE_VAL, high = -HUGE_VAL;
    std::int32_t block = kNoBlock;

    void include(const TriangleBounds& bounds) {
        low = std::min(low, bounds.low);
        high = std::max(high, bounds.high);
    }
};

/// What the filter compares a surface with: facets that are whole triangles, then parts.
struct FacetView {
    std::span<const PlaneId> whole;
    std::span<const std::int32_t> whole_block;  ///< beneath each; none at all: one block
    const PolygonPool& parts;
    std::span<const PlaneId> part_plane;
    std::span<const std::int32_t> part_block;
    const std::vector<Cover>& cover;  ///< of each tile

    std::size_t size() const { return whole.size() + part_plane.size(); }
    bool is_whole(std::size_t i) const { return i < whole.size(); }
    PlaneId plane(std::size_t i) const {
        return is_whole(i) ? whole[i] : part_plane[i - whole.size()];
    }
    std::int32_t block(std::size_t i) const {
        if (whole_block.empty() && part_block.empty()) return 0;
        return is_whole(i) ? whole_block[i] : part_block[i - whole.size()];
    }
};

/// What the filter found of a triangle or facet.
enum class Standing : std::uint8_t {
    kBelow,      ///< below all that it shares a position in plan with
    kAbove,      ///< above all of it, or the same triangle as a facet
    kUncovered,  ///< of a facet: there is no surface at all
    kExact,      ///< to be overlaid exactly
    kToCompare   ///< while the filter works
};

/// Which triangles may stay whole: those of facets and of a surface that bounds certainly sort
/// above or below whatever they share a position in plan with. They need neither lines nor points.
///
/// Tiles that a border crosses (an edge where the neighboring triangle is missing or at another
/// height) are marked: there walls may stand, so heights in tiles decide nothing, and what a border
/// divides is exact.
class WholeTriangleFilter {
public:
    WholeTriangleFilter(const exact::PlanArrangement& geometry, const BorderEdges& borders,
                        double largest_height, const Execution& execution)
        : geometry_(geometry),
          borders_(borders),
          // Well above what rounding moves vertices by: what bounds keep apart stays apart.
          margin_(largest_height * 0x1p-40),
          execution_(execution) {}

    /// Takes the next surface, whatever it is compared with.
    void begin(const BlockTiling& tiling);
    /// Compares the surface with facets.
    void compare(const FacetView& facets);
    /// The same, but only asks whether the surface covers facets: those it does are kBelow it.
    void cover(const FacetView& facets);
    /// The part of the surface that meets exact facets, or is exact: triangles in outlines of their
    /// own, then parts, then where there is no surface at all.
    /// @param with_void  whether facets without a plane count as others do
    SurfaceTiling exact_part(exact::PlanArrangement& geometry, const TriangleLinks& links,
                             const FacetView& facets, bool with_void = false);
    /// The numbers of exact facets, in order.
    std::vector<std::size_t> exact_facets() const;

    const PlanTiles& tiles() const { return borders_.tiles(); }
    TileBounds located(const TriangleBounds& bounds) const {
        return {bounds, tiles().span(bounds.box)};
    }

    // Of the triangles and parts of the surface:
    Array<TileBounds> surface_at;
    std::vector<Standing> surface;
    std::vector<std::int32_t> block;     ///< above, of each that is below
    std::vector<std::int32_t> polygon;   ///< in the exact part, or -1
    std::vector<std::uint8_t> is_empty;  ///< of each tile without a border: no surface there
    // Of the facets:
    Array<TileBounds> facet_at;
    std::vector<Standing> facet;

private:
    void locate(const FacetView& facets, bool with_heights);
    void measure_surface();
    void measure_facets(const FacetView& facets);
    void classify_surface(const FacetView& facets);
    void compare_surface(const FacetView& facets, const std::vector<std::uint8_t>& is_wanted);
    void compare_triangle(const FacetView& facets, const spatial::TileBins& bins, std::size_t t);
    void classify_facets(const FacetView& facets);
    void compare_facets(const FacetView& facets, const std::vector<std::uint8_t>& is_wanted);
    Standing compare_facet(PlaneId facet, const TileBounds& at,
                           const spatial::TileBins& bins) const;
    bool is_to_compare(std::size_t triangle) const {
        return surface[triangle] == Standing::kExact &&
               (block[triangle] >= 0 || block[triangle] == kBesideBorder);
    }
    void mark_tiles(const TileSpan& span, std::vector<std::uint8_t>& marks) const;

    const exact::PlanArrangement& geometry_;
    const BorderEdges& borders_;
    double margin_;
    Execution execution_;
    const BlockTiling* tiling_ = nullptr;
    std::vector<TileContent> surface_tiles_, facet_tiles_;
    std::vector<std::uint8_t> is_unclear_;  ///< of each tile: exact triangles or parts meet it
    std::vector<std::uint8_t>
        is_same_;  ///< of each plane, for raised surfaces: a facet, a triangle
};

}  // namespace realmodel::strata
