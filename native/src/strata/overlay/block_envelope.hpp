// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "strata/overlay/facet_overlay.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

/// Facets that bounds sorted above a surface: the nodes beneath the triangles come first, one after
/// another, then those beneath the pieces.
struct CoveredFacets {
    std::int32_t first_node = 0;
    std::vector<PlaneId> wholes;
    std::vector<std::size_t> pieces;  ///< of the envelope's
};

/// The envelope of one rock mass while blocks are built: triangles that the filter sorts wholly
/// above or below what they meet are neither cut nor named anywhere; only the others are overlaid.
class BlockEnvelope {
public:
    BlockEnvelope(exact::PlanArrangement& geometry, const TriangleLinks& links,
                  const BorderEdges& borders, double largest_height, Construction& construction,
                  WholeTriangles& wholes, const Execution& execution);

    /// Begins under the sky over a region (what is covered), with the outside around it.
    void start_region(const FrameTriangles& filling);
    /// Begins under the sky over what a region and a window have in common, which `pieces` are.
    void start_window(const FrameTriangles& region, const FrameTriangles& window, Envelope pieces);
    /// Lays the next older surface under the envelope; the first one, without a region, is it.
    void add(const BlockTiling& tiling, std::int32_t number);
    /// The lowest position of the envelope.
    std::array<double, 3> lowest() const;
    /// Closes what is left, down to a flat base where there is one.
    void finish(std::optional<PlaneId> base);

private:
    FacetView view() const {
        return {whole_,
                whole_block_,
                pieces_.outlines,
                {pieces_.plane.begin(), pieces_.plane.end()},
                {pieces_.block_beneath.begin(), pieces_.block_beneath.end()},
                cover_};
    }
    void add_sky(const PlanTriangle& triangle, PlaneId plane, Cover cover);
    void cover_tiles(const PlanTriangle& triangle, Cover cover);
    void start(const BlockTiling& tiling, std::int32_t number);
    void enter(PlaneId plane, std::int32_t number, std::int32_t node_above, const TileSpan& span);
    Overlaid overlay_exactly(const FacetView& facets, const SurfaceTiling& exact_tiling,
                             std::int32_t number);
    void sort_overlaid(const Envelope& remaining, std::size_t first_face);
    CoveredFacets sort_facets(std::int32_t number);
    std::vector<std::uint8_t> find_whole(const SurfaceTiling& exact_tiling,
                                         const PiecesOfPolygons& pieces, const Overlaid& overlaid,
                                         std::size_t triangles) const;
    void add_surface(const BlockTiling& tiling, const SurfaceTiling& exact_tiling,
                     std::int32_t number, Overlaid& overlaid);

    bool is_triangle(PolygonView polygon, PlaneId plane) const;
    const PlanTiles& tiles() const { return borders_.tiles(); }

    exact::PlanArrangement& geometry_;
    const TriangleLinks& links_;
    const BorderEdges& borders_;
    Construction& construction_;
    WholeTriangles& wholes_;
    Execution execution_;
    WholeTriangleFilter filter_;
    bool is_started_ = false;
    std::vector<PlaneId> whole_, next_whole_;
    std::vector<std::int32_t> whole_block_, next_whole_block_;  ///< beneath each
    Envelope pieces_, next_pieces_;  ///< facets that are pieces of triangles; the sky, the outside
    std::vector<Cover> cover_;       ///< of each tile without a border
    std::vector<std::int32_t> node_above_;  ///< of the surface's triangles that are below
};

}  // namespace realmodel::strata
