// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include "base/counting_sort.hpp"
#include "strata/conform/collinear_lines.hpp"
#include "strata/conform/matched_edges.hpp"

namespace realmodel::strata {

/// The edges of faces in buckets of as many lines each, so that those of a bucket fit the cache:
/// they are put in order by lines, with their ends, when it is their turn. Half of the buckets are
/// filled at a time, as all edges would take nearly as much memory as the faces.
class LineBuckets {
public:
    /// @throws InputError kind too_large, where edges cannot be numbered
    LineBuckets(const FaceList& faces, const CollinearLines& lines);

    std::size_t size() const { return (lines_.representative.size() + together_ - 1) / together_; }
    std::size_t first_line(std::size_t bucket) const {
        return std::min(bucket * together_, lines_.representative.size());
    }
    /// Fills some buckets, and empties all others.
    void fill(std::size_t begin, std::size_t end, const Execution& execution);
    /// The edges of a bucket that is filled by its lines; their ends are plan vertices.
    Buckets<LineEdge> by_lines(std::size_t bucket, const PlanVertices& plan_vertices) const;

private:
    struct Edge {
        std::uint32_t corner;  ///< that it leaves
        std::int32_t face;
    };
    /// Of the edge that leaves a corner.
    std::size_t joined_line(std::size_t corner) const {
        return static_cast<std::size_t>(lines_.of_line[index(faces_.polygons.lines[corner].id())]);
    }
    void prefetch_edge(const Edge* edge, const Edge* end) const;

    const FaceList& faces_;
    const CollinearLines& lines_;
    std::size_t together_;  ///< lines in a bucket
    std::size_t first_filled_ = 0;
    Buckets<Edge> edges_;  ///< of those that are filled
};

}  // namespace realmodel::strata
