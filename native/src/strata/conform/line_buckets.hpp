// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "strata/conform/collinear_lines.hpp"
#include "strata/conform/conforming.hpp"

namespace realmodel::strata {

/// The face edges of some tracks, track by track.
class BucketEdges {
public:
    std::span<LineEdge> operator[](std::size_t track) {
        return {edges_.data() + offsets_[track], edges_.data() + offsets_[track + 1]};
    }

private:
    friend class LineBuckets;
    /// An edge as it is found, and its track.
    struct Found {
        LineEdge edge;
        std::uint32_t track;
    };
    std::vector<std::uint32_t> offsets_;
    GrowingArray<LineEdge> edges_;
    GrowingArray<Found> found_;
};

/// All tracks in buckets of about as many edges each. Of a bucket only the faces are kept that have
/// edges on its tracks: the edges themselves are put together when it is their turn, so that they
/// are never all there at once.
class LineBuckets {
public:
    /// @throws InputError kind too_large, where edges cannot be numbered
    LineBuckets(const FaceList& faces, const CollinearLines& lines, int threads,
                const Progress* progress);

    std::size_t size() const { return first_.size() - 1; }
    std::size_t first_track(std::size_t bucket) const {
        return std::min(bucket * tracks_together_, tracks_);
    }
    /// Puts the edges of a bucket's tracks together; their ends are places.
    void collect(std::size_t bucket, const PlanVertices& places, BucketEdges& into) const;

private:
    using Found = BucketEdges::Found;
    std::size_t track_of(const Corner& corner) const {
        const auto line = static_cast<std::size_t>(exact::line_of(corner.line));
        return static_cast<std::size_t>(lines_.of_line[line]);
    }
    void prefetch_faces(std::size_t number, std::size_t end) const;

    const FaceList& faces_;
    const CollinearLines& lines_;
    std::size_t tracks_, tracks_together_;
    std::vector<std::size_t> first_;           ///< of each bucket among the faces
    FlatArray<std::int32_t> faces_of_bucket_;  ///< ascending within each
};

}  // namespace realmodel::strata
