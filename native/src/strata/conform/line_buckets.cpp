// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/line_buckets.hpp"

#include <bit>

#include "base/parallel_counts.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kEdges = 1 << 14;         // in a bucket: they fit the cache of a core
constexpr std::size_t kMostEdges = 2000000000;  // so that plan vertices on lines can be numbered
constexpr std::size_t kFacesSorted = 1 << 15,
                      kMostFaceChunks = 64;  // sorted into buckets at a time

}  // namespace

LineBuckets::LineBuckets(const FaceList& faces, const CollinearLines& lines)
    : faces_(faces), lines_(lines) {
    const std::size_t edges = faces.polygons.lines.size();
    check_total(edges, kMostEdges);
    const std::size_t of_line = edges / std::max<std::size_t>(lines.representative.size(), 1) + 1;
    together_ = std::bit_floor(std::max<std::size_t>(kEdges / of_line, 1));
}

void LineBuckets::fill(std::size_t begin, std::size_t end, const Execution& execution) {
    edges_ = {};
    first_filled_ = begin;
    const std::uint32_t* const offsets = faces_.polygons.offsets.begin();
    const std::size_t first = first_line(begin), count = first_line(end) - first;
    const int shift = std::countr_zero(together_);
    const std::size_t chunks =
        std::clamp<std::size_t>(faces_.size() / kFacesSorted, 1, kMostFaceChunks);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t past_last = faces_.size() * (chunk + 1) / chunks;
        for (std::size_t f = faces_.size() * chunk / chunks; f < past_last; ++f) {
            for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) {
                const std::size_t line = joined_line(c) - first;  // huge, where before
                if (line < count) put(line >> shift, Edge{c, static_cast<std::int32_t>(f)});
            }
        }
    };
    edges_ = bucketize_in_order<Edge>(end - begin, chunks, produce, execution, 0.1);
}

/// Asks for what will be read of the edges after one, and for what matching will want to know.
[[gnu::always_inline]] inline void LineBuckets::prefetch_edge(const Edge* edge,
                                                              const Edge* end) const {
    const Edge& far = edge[std::min<std::ptrdiff_t>(32, end - edge - 1)];
    const std::size_t face = index(far.face);
    prefetch(&faces_.polygons.points[far.corner]);
    prefetch(&faces_.polygons.lines[far.corner]);
    prefetch(&faces_.polygons.offsets[face]);
    prefetch(&faces_.plane[face]);
    prefetch(&faces_.above[face]);
    prefetch(&faces_.below[face]);
}

Buckets<LineEdge> LineBuckets::by_lines(std::size_t bucket,
                                        const PlanVertices& plan_vertices) const {
    const std::uint32_t* const offsets = faces_.polygons.offsets.begin();
    const PointId* const points = faces_.polygons.points.begin();
    const PlanVertexId* const of_point = plan_vertices.of_point.begin();
    const std::size_t first = first_line(bucket);
    const std::span<const Edge> edges = edges_[bucket - first_filled_];
    const auto produce = [&](const auto& put) {
        for (const Edge& edge : edges) {
            prefetch_edge(&edge, edges.data() + edges.size());
            const std::size_t face = index(edge.face);
            const std::size_t next =
                edge.corner + 1 < offsets[face + 1] ? edge.corner + 1 : offsets[face];
            put(joined_line(edge.corner) - first,
                LineEdge{of_point[index(points[edge.corner])], of_point[index(points[next])],
                         edge.corner, edge.face});
        }
    };
    return bucketize<LineEdge>(first_line(bucket + 1) - first, produce);
}

}  // namespace realmodel::strata
