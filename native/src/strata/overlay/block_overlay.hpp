// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "strata/overlay/border_edges.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/plan_tiles.hpp"
#include "strata/tiling/block_tiling.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Plan box and heights of a triangle.
struct TriangleBounds {
    PlanBox box;
    double low, high;
};
TriangleBounds bounds_of(const exact::PlanArrangement& geometry, PlaneId plane);

/// The same, and the tiles that the box meets.
struct TileBounds {
    TriangleBounds bounds;
    TileSpan span;
};

/// A triangle that is a facet of the envelope as a whole, with one face above it.
struct WholeFacet {
    PlaneId plane;
    std::int32_t pending;  ///< the block beneath
    std::int32_t above;    ///< node, or kOutsideCell
};

/// A face at rest: a whole triangle between two nodes.
struct WholeFace {
    std::int32_t above = kUnset, below = kUnset;  ///< nodes, or kOutsideCell
    static constexpr std::int32_t kUnset = -2;
    bool is_face() const { return below != kUnset && (above >= 0 || below >= 0); }
};

/// What the overlay leaves of the triangles. Nodes are pieces of blocks, of which `links` and later
/// steps join what hangs together.
struct BlockConstruction {
    FaceList faces;                        ///< faces that are parts of triangles, between nodes
    std::vector<std::int32_t> node_block;  ///< of each node
    std::vector<std::pair<std::int32_t, std::int32_t>> links;
    std::vector<WholeFace> whole;  ///< for each plane
    /// For each plane: looked at more closely than by bounds, or beside a border.
    std::vector<std::uint8_t> is_exact;
    std::vector<std::uint8_t> is_in_parts;  ///< for each plane: divided into several faces
    std::vector<std::pair<PlaneId, std::int32_t>>
        on_base;  ///< facets over the base, and their nodes
};

/// Builds blocks without columns: the overlay of overlay.hpp, but triangles that bounds tell to lie
/// wholly above or below what they meet are neither cut nor named anywhere; they stay whole, and
/// what they bound is told by propagation. Only what really meets is overlaid, exactly.
///
/// Tiles that a border crosses (an edge where the neighbouring triangle is missing or at another
/// height) are marked: there walls may stand, so everything is overlaid there.
class BlockOverlay {
public:
    /// layers: oldest first, their planes one after another.
    BlockOverlay(exact::PlanArrangement& geometry, std::span<const BlockTiling> layers,
                 BorderEdges borders, double largest_height, int threads, const Progress* progress);

    /// Begins under the sky over a region (in triangles), with `outside` around it.
    void start_region(const std::vector<PlanTriangle>& region,
                      const std::vector<PlanTriangle>& outside);
    /// Lays the next older surface under the envelope; the first one, without a region, is it.
    void add(std::int32_t number);
    /// The lowest place of the envelope.
    std::array<double, 3> lowest() const;
    /// Closes what is left, down to a flat base where there is one.
    void finish(std::optional<PlaneId> base);

    std::int32_t layer_of(PlaneId plane) const;
    /// Planes of the neighbouring triangles, -1 where there is none.
    std::array<PlaneId, 3> neighbours_of(PlaneId plane) const;
    /// A triangle's outline, its lines made where they are new.
    Polygon outline_of(PlaneId plane);
    /// Adds those of several triangles.
    void add_outlines(std::span<const PlaneId> planes, PolygonPool& pool);

    std::span<const BlockTiling> layers() const { return layers_; }
    BlockConstruction& construction() { return made_; }
    const BorderEdges& borders() const { return borders_; }

private:
    struct SurfaceTiles;
    struct EnvelopeTiles;
    struct Classified;

    void locate(const BlockTiling& layer);
    SurfaceTiles surface_tiles(const BlockTiling& layer) const;
    EnvelopeTiles envelope_tiles() const;
    void start_sky(const BlockTiling& layer);
    void classify_surface(const BlockTiling& layer, const EnvelopeTiles& envelope, Classified& c);
    static bool is_to_compare(const Classified& c, std::size_t triangle);
    void mark_tiles(const TileSpan& span, std::vector<std::uint8_t>& marks) const;
    void compare_surface(const BlockTiling& layer, const std::vector<std::uint8_t>& is_wanted,
                         Classified& c);
    void classify_facets(const BlockTiling& layer, const SurfaceTiles& surface, Classified& c);
    void compare_facets(const BlockTiling& layer, const std::vector<std::uint8_t>& is_wanted,
                        Classified& c);
    void add_outlines(const BlockTiling& layer, const std::vector<std::int32_t>& polygon,
                      SurfaceTiling& part);
    SurfaceTiling needed_part(const BlockTiling& layer, Classified& c);
    void overlay_exactly(const BlockTiling& layer, const SurfaceTiling& part,
                         const SurfaceTiles& surface, Classified& c);
    void rest_facets(const BlockTiling& layer, Classified& c);
    void link_closed(const BlockTiling& layer, const Classified& c);
    void add_surface(const BlockTiling& layer, const SurfaceTiling& part, Classified& c);

    std::int32_t new_node(std::int32_t block) {
        made_.node_block.push_back(block);
        return static_cast<std::int32_t>(made_.node_block.size()) - 1;
    }
    TileBounds located(const TriangleBounds& bounds) const {
        return {bounds, tiles().span(bounds.box)};
    }
    const PlanTiles& tiles() const { return borders_.tiles(); }
    std::int32_t block_of(std::int32_t node) const {
        return made_.node_block[static_cast<std::size_t>(node)];
    }

    exact::PlanArrangement& geometry_;
    std::span<const BlockTiling> layers_;
    BorderEdges borders_;
    double margin_;
    int threads_;
    const Progress* progress_;
    BlockConstruction made_;
    bool started_ = false;
    std::vector<WholeFacet> whole_, next_whole_;
    Envelope parts_, next_parts_;  ///< facets that are parts of triangles; the sky, the outside
    /// Of the triangles of the surface that is being added, and of the facets.
    GrowingArray<TileBounds> surface_at_, whole_at_, part_at_;
    std::vector<std::uint8_t>
        cover_;  ///< of each tile without a border: what the envelope is there
};

}  // namespace realmodel::strata
