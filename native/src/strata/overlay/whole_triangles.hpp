// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "spatial/plan_tiles.hpp"
#include "strata/overlay/border_edges.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Plan box and heights of a triangle.
struct TriangleBounds {
    PlanBox box;
    double low, high;
};
TriangleBounds bounds_of(const exact::PlanArrangement& geometry, PlaneId plane);

/// What a pair of triangles is to each other where they share a position in plan, for certain.
enum class Comparison { kBelow, kAbove, kApart, kUnclear };

/// Compares triangle `lower` with triangle `upper`, of which at least what lies in two boxes
/// counts: their difference over the intersection of the boxes decides, or over either triangle.
Comparison compare_over(const exact::PlanArrangement& geometry, PlaneId lower, PlaneId upper,
                        const PlanBox& lower_box, const PlanBox& upper_box, double margin);

/// Whether two triangles share no position in plan, not even a corner, for certain.
bool are_apart(const exact::PlanArrangement& geometry, PlaneId a, PlaneId b);

/// The middle of some corners, as rounding leaves it.
template <class Corners, class PointOf>
std::array<double, 2> middle_of(const Corners& corners, const PointOf& point_of) {
    std::array<double, 2> middle{0, 0};
    const double share = 1.0 / static_cast<double>(corners.size());
    for (const auto& corner : corners) {
        const exact::Point& p = point_of(corner);
        middle[0] += p.x * share;
        middle[1] += p.y * share;
    }
    return middle;
}
std::array<double, 2> middle_of(const exact::PlanArrangement& geometry, PlaneId plane);

/// On which side of a triangle's border a position lies that rounding may have moved: 1 inside for
/// certain, -1 outside for certain, 0 near the border.
int side_of_border(const exact::PlanArrangement& geometry, const PlanTriangle& triangle,
                   const std::array<double, 2>& position);

/// Plan positions of a triangle's corners.
inline std::array<std::array<double, 2>, 3> corners_of(const exact::PlanArrangement& geometry,
                                                       const PlanTriangle& triangle) {
    std::array<std::array<double, 2>, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
        p[i] = {geometry.point(triangle[i]).x, geometry.point(triangle[i]).y};
    return p;
}

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

/// What the filter compares a surface with: facets that are whole triangles, then pieces.
struct FacetView {
    std::span<const PlaneId> whole;
    std::span<const std::int32_t> whole_block;  ///< beneath each; none at all: one block
    const PolygonPool& pieces;
    std::span<const PlaneId> piece_plane;
    std::span<const std::int32_t> piece_block;
    const std::vector<Cover>& cover;  ///< of each tile

    std::size_t size() const { return whole.size() + piece_plane.size(); }
    bool is_whole(std::size_t i) const { return i < whole.size(); }
    PlaneId plane(std::size_t i) const {
        return is_whole(i) ? whole[i] : piece_plane[i - whole.size()];
    }
    std::int32_t block(std::size_t i) const {
        if (whole_block.empty() && piece_block.empty()) return 0;
        return is_whole(i) ? whole_block[i] : piece_block[i - whole.size()];
    }
};

/// How high a triangle or facet is against what it shares a position in plan with.
enum class HeightRelation : std::uint8_t {
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
    /// own, then pieces, then where there is no surface at all.
    /// @param with_void  whether facets without a plane count as others do
    SurfaceTiling make_exact_tiling(exact::PlanArrangement& geometry, const FacetView& facets,
                                    bool with_void = false);
    /// The numbers of exact facets, in order.
    std::vector<std::size_t> exact_facets() const;

    const PlanTiles& tiles() const { return borders_.tiles(); }
    TileBounds located(const TriangleBounds& bounds) const {
        return {bounds, tiles().span(bounds.box)};
    }

    // Of the triangles and pieces of the surface:
    Array<TileBounds> surface_at;
    std::vector<HeightRelation> surface;
    std::vector<std::int32_t> block;     ///< above, of each that is below
    std::vector<std::int32_t> polygon;   ///< in the exact tiling, or -1
    std::vector<std::uint8_t> is_empty;  ///< of each tile without a border: no surface there
    // Of the facets:
    Array<TileBounds> facet_at;
    std::vector<HeightRelation> facet;

private:
    void locate(const FacetView& facets, bool with_heights);
    void measure_surface();
    void measure_facets(const FacetView& facets);
    void classify_surface(const FacetView& facets);
    void compare_surface(const FacetView& facets, const std::vector<std::uint8_t>& is_wanted);
    void compare_triangle(const FacetView& facets, const spatial::TileBins& bins, std::size_t t);
    void classify_facets(const FacetView& facets);
    void compare_facets(const FacetView& facets, const std::vector<std::uint8_t>& is_wanted);
    HeightRelation compare_facet(PlaneId facet, const TileBounds& at,
                                 const spatial::TileBins& bins) const;
    bool is_to_compare(std::size_t triangle) const {
        return surface[triangle] == HeightRelation::kExact &&
               (block[triangle] >= 0 || block[triangle] == kBesideBorder);
    }
    void mark_tiles(const TileSpan& span, std::vector<std::uint8_t>& marks) const;

    const exact::PlanArrangement& geometry_;
    const BorderEdges& borders_;
    double margin_;
    Execution execution_;
    const BlockTiling* tiling_ = nullptr;
    std::vector<TileContent> surface_tiles_, facet_tiles_;
    std::vector<std::uint8_t> is_unclear_;  ///< of each tile: exact triangles or pieces meet it
    std::vector<std::uint8_t>
        is_same_;  ///< of each plane, for raised surfaces: a facet, a triangle
};

/// A whole triangle between two nodes.
struct WholeFace {
    static constexpr std::int32_t kUnset = -2;
    std::int32_t above = kUnset, below = kUnset;  ///< nodes, or kOutsideCell
    std::int32_t surface = -1;                    ///< number of the surface that it is of

    bool is_set() const { return below != kUnset; }
    bool is_face() const { return is_set() && (above >= 0 || below >= 0); }
};

/// Whether a triangle is divided into several faces.
enum class PieceState : std::uint8_t {
    kWhole,
    kInPieces,
    kMayStayWhole,  ///< while it is overlaid
    kStaysWhole     ///< as that has shown
};

/// What the overlays of blocks leave of whole triangles, in all rock masses.
struct WholeTriangles {
    std::vector<WholeFace> face;  ///< of each plane
    /// Of each plane: looked at more closely than by bounds, or beside a border.
    std::vector<std::uint8_t> is_exact;
    std::vector<PieceState> piece_state;  ///< of each plane
    std::vector<std::uint8_t> is_added;   ///< of each plane: among the conforming faces
    struct BaseFace {
        PlaneId plane, base;
        std::int32_t node;
    };
    std::vector<BaseFace> on_base;  ///< beneath whole triangles

    explicit WholeTriangles(std::size_t planes)
        : face(planes), is_exact(planes), piece_state(planes), is_added(planes) {}
    WholeFace& of(PlaneId plane) { return face[index(plane)]; }
    const WholeFace& of(PlaneId plane) const { return face[index(plane)]; }
};

}  // namespace realmodel::strata
