// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/overlay/surface_facets.hpp"

namespace realmodel::strata {

/// A piece of the surface that becomes part of the envelope.
struct PieceBelow {
    std::int32_t polygon;     ///< of the tiling
    std::int32_t node_above;  ///< counted within the chunk, kOutsideCell or kLeftOut
};

/// A facet all of whose faces are finished, as they are: one node is beneath it.
struct ClosedFacet {
    std::uint32_t facet;
    std::int32_t node;   ///< counted within the chunk
    std::size_t before;  ///< how many of the chunk's own faces come first
};

/// What one chunk of facets became. Lines and points are the scope's for as long as there is one;
/// nodes are counted from 0.
struct ChunkResult {
    /// Makes room for what most chunks of so many facets become.
    ChunkResult(const exact::PlanArrangement& geometry, std::size_t facets);

    std::unique_ptr<LocalArrangement> scope;
    Array<std::int32_t> node_block;
    Array<std::uint8_t> node_is_thick;
    FacesOf<PolygonPool> faces;  ///< finished; above is a shared node, below one of the chunk's
    Array<ClosedFacet> closed;   ///< whose faces come between these
    std::size_t closed_faces = 0, closed_corners = 0;
    PolygonPool below_outlines;
    Array<PieceBelow> below;
    Envelope kept;

    std::array<PolygonPool*, 4> pools() {
        return {&faces.polygons, &below_outlines, &kept.outlines, &kept.face_polygons};
    }
};

/// Polygons and corners counted up to a chunk.
struct PoolStart {
    std::size_t polygon = 0, corner = 0;
};

/// Where the elements of a chunk go.
struct ChunkStart {
    std::int64_t node = 0;
    PoolStart face, below, facet, facet_face;

    void pass(const ChunkResult& chunk);
};

/// Puts what the chunks became behind what is there already, in order of chunks. A chunk is put
/// there as soon as it was committed, by any thread, and its memory is the next one's; what there
/// is no room for waits until all are done.
class ChunkJoining {
public:
    /// Makes room for what becomes of the facets of most envelopes.
    ChunkJoining(std::vector<std::unique_ptr<ChunkResult>>& chunks, const Envelope& envelope,
                 Construction& construction, Envelope& next, PiecesBelow& below);

    /// Finds where a chunk goes; to be called once for each, in order, by one thread at a time.
    /// @throws InputError kind too_large, where there are more nodes than numbers for them
    void find_offset(std::size_t chunk);
    /// Puts a chunk whose offset was found there, if there is room; several threads may do so.
    void put_where_room(std::size_t chunk);
    /// Puts what is left. To be called once, when all have their offsets.
    void finish(const Execution& execution);

private:
    bool has_room();
    void put(std::size_t chunk);
    void put_faces(const ChunkResult& chunk, const ChunkStart& at);

    std::vector<std::unique_ptr<ChunkResult>>& chunks_;
    const Envelope& envelope_;
    Construction& construction_;
    Envelope& next_;
    PiecesBelow& below_;
    std::vector<ChunkStart> start_;
    std::vector<std::uint8_t> fits_;  ///< of each chunk, whether there is room for it
    ChunkStart end_;                  ///< of the chunks that have their offsets
};

}  // namespace realmodel::strata
