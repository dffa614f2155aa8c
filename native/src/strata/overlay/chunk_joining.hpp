// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "strata/overlay/envelope.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// Commits the local lines and points of many chunks in the order of the chunks, whichever is
/// finished first, by whatever thread is free while others still work: the ids do not depend on
/// threads, and nobody waits for more than the counting of ids.
class OrderedCommit {
public:
    /// `facets`: those of all chunks.
    OrderedCommit(exact::PlanArrangement& geometry, std::size_t chunks, std::size_t facets)
        : geometry_(geometry), finished_(chunks) {
        // What others read must not move. Most facets find fewer lines and points than this; where
        // one finds more, the rest waits until all are done.
        geometry.make_room(facets * 4 + 1024, facets * 8 + 1024);
    }

    /// Chunks from `first` to `last` - 1.
    struct Chunks {
        std::size_t first = 0, last = 0;
    };
    struct Nothing {
        void operator()(std::size_t) const {}
    };

    /// To be called when nothing more will be found in the local arrangement of a chunk. `passed`
    /// is called with each chunk that has its ids, in order, by one thread at a time.
    /// @return the chunks that this call committed, which may be none or other ones
    template <class Passed = Nothing>
    Chunks finished(std::size_t chunk, LocalArrangement& local, const Passed& passed = {}) {
        return commit([&] { finished_[chunk] = &local; },
                      [&](const LocalArrangement& next) { return next.has_room_in(geometry_); },
                      passed);
    }

    /// To be called when all chunks are finished: commits what is left, and returns it.
    template <class Passed = Nothing>
    Chunks finish(const Passed& passed = {}) {
        return commit([] {}, [](const LocalArrangement&) { return true; }, passed);
    }

private:
    template <class Begin, class MayCommit, class Passed>
    Chunks commit(const Begin& begin, const MayCommit& may_commit, const Passed& passed) {
        Chunks chunks;
        {
            const std::lock_guard lock(busy_);
            begin();
            chunks.first = next_;
            for (; next_ < finished_.size() && finished_[next_] != nullptr &&
                   may_commit(*finished_[next_]);
                 ++next_) {
                finished_[next_]->reserve_ids(geometry_);
                passed(next_);
            }
            chunks.last = next_;
        }
        for (std::size_t c = chunks.first; c < chunks.last; ++c)
            finished_[c]->write_marked();
        return chunks;
    }

    exact::PlanArrangement& geometry_;
    std::vector<LocalArrangement*> finished_;  ///< of each chunk that is; with busy_
    std::mutex busy_;
    std::size_t next_ = 0;  ///< chunk to be committed; with busy_
};

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
    Envelope remaining;

    std::array<PolygonPool*, 4> pools() {
        return {&faces.polygons, &below_outlines, &remaining.outlines, &remaining.face_polygons};
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
