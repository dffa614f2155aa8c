// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "strata/overlay/block_overlay.hpp"

namespace realmodel::strata {

/// A piece of the surface that becomes part of the envelope.
struct LoweredPiece {
    std::int32_t polygon;  ///< of the layer
    std::int32_t node;     ///< above it, or kOutsideCell
    bool is_strict;        ///< nowhere as high as the facet above it
};

/// Facets to be overlaid exactly: first `whole` triangles with one face each, then parts.
struct ExactFacets {
    Envelope facets;
    std::size_t whole = 0;
    /// Of each part: whether the layer has everything that it meets. Only the sky and the outside
    /// may lack what bounds tell about.
    std::vector<std::uint8_t> is_complete;
    std::vector<TileSpan> span;  ///< of each facet
};

/// What a chunk of facets became. Lines and points are the scope's, nodes are counted from 0.
struct OverlaidChunk {
    struct ClosedWhole {
        PlaneId plane;
        std::int32_t above, below;
    };
    explicit OverlaidChunk(const exact::PlanArrangement& geometry) : scope(geometry) {}

    LocalArrangement scope;
    std::vector<std::int32_t> node_block;
    FaceList faces;  ///< above is a shared node, below one of the chunk's
    std::vector<ClosedWhole> closed_whole;
    std::vector<PlaneId> divided_whole;
    std::vector<WholeFacet> kept_whole;
    Envelope kept;
    PolygonPool lowered_outlines;
    std::vector<LoweredPiece> lowered;

    std::array<PolygonPool*, 4> pools() {
        return {&faces.polygons, &lowered_outlines, &kept.outlines, &kept.face_polygons};
    }
};

/// Overlays facets with part of surface `number`; marks polygons of it that do not lie below as a
/// whole. What lies under a facet is one node where no border divides it.
std::vector<std::unique_ptr<OverlaidChunk>> overlay_facets(
    exact::PlanArrangement& geometry, const ExactFacets& exact, const SurfaceTiling& layer,
    std::int32_t number, const BorderEdges& borders, std::vector<std::uint8_t>& is_divided,
    int threads, const Progress* progress);

}  // namespace realmodel::strata
