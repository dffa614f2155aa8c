// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "strata/conform/collinear_lines.hpp"
#include "strata/conform/matched_edges.hpp"

namespace realmodel::strata {

/// The face edges of some lines, line by line.
class BucketEdges {
public:
    std::span<LineEdge> operator[](std::size_t line) {
        return {edges_.data() + offsets_[line], edges_.data() + offsets_[line + 1]};
    }

private:
    friend class LineBuckets;
    std::vector<std::uint32_t> offsets_;
    Array<LineEdge> edges_;  ///< and behind them what is on lines of other buckets
};

/// All lines in buckets of about as many edges each. Of a bucket only the faces are kept that have
/// edges on its lines: the edges themselves are put together when it is their turn, so that they
/// are never all there at once.
class LineBuckets {
public:
    /// @throws InputError kind too_large, where edges cannot be numbered
    LineBuckets(const FaceList& faces, const CollinearLines& lines, const Execution& execution);

    std::size_t size() const { return first_.size() - 1; }
    std::size_t first_line(std::size_t bucket) const {
        return std::min(bucket * lines_together_, line_count_);
    }
    /// Puts the edges of a bucket's lines together; their ends are plan vertices.
    void collect(std::size_t bucket, const PlanVertices& plan_vertices, BucketEdges& into) const;

private:
    /// Of the edge that leaves a corner.
    std::size_t joined_line(std::size_t corner) const {
        const LineId line = faces_.polygons.lines[corner].id();
        return static_cast<std::size_t>(lines_.of_line[index(line)]);
    }
    void prefetch_faces(std::size_t number, std::size_t end) const;

    const FaceList& faces_;
    const CollinearLines& lines_;
    std::size_t line_count_, lines_together_;
    std::vector<std::size_t> first_;       ///< of each bucket among the faces
    Array<std::int32_t> faces_of_bucket_;  ///< ascending within each
};

}  // namespace realmodel::strata
