// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/line_buckets.hpp"

#include <algorithm>
#include <bit>

#include "base/parallel_counts.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kEdges = 1 << 14;         // in a bucket: they fit the cache of a core
constexpr std::size_t kMostEdges = 2000000000;  // so that plan vertices on lines can be numbered
constexpr std::size_t kCorners = 1 << 17, kMostCornerChunks = 64;  // sorted into buckets at a time

/// How many faces of a chunk are in a bucket, or where the next of them goes.
struct Filling {
    std::uint32_t count = 0;
    std::int32_t last_face = -1;  ///< counted, for one that has several edges there
};

}  // namespace

LineBuckets::LineBuckets(const FaceList& faces, const CollinearLines& lines,
                         const Execution& execution)
    : faces_(faces), lines_(lines), line_count_(lines.representative.size()) {
    const SplitPolygons& polygons = faces.polygons;
    const std::size_t corners = polygons.lines.size();
    check_total(corners, kMostEdges);
    const std::size_t edges_of_line = corners / std::max<std::size_t>(line_count_, 1) + 1;
    lines_together_ = std::bit_floor(std::max<std::size_t>(kEdges / edges_of_line, 1));
    const std::size_t buckets = (line_count_ + lines_together_ - 1) / lines_together_;
    const int shift = std::countr_zero(lines_together_);

    const std::size_t chunks = std::clamp<std::size_t>(corners / kCorners, 1, kMostCornerChunks);
    std::vector<std::vector<Filling>> filling(chunks);
    const auto for_each_once = [&](std::size_t chunk, const auto& visit) {
        const std::size_t end = faces.size() * (chunk + 1) / chunks;
        for (std::size_t f = faces.size() * chunk / chunks; f < end; ++f) {
            const auto face = static_cast<std::int32_t>(f);
            for (std::size_t c = polygons.offsets[f]; c < polygons.offsets[f + 1]; ++c) {
                Filling& bucket = filling[chunk][joined_line(c) >> shift];
                if (bucket.last_face == face) continue;
                bucket.last_face = face;
                visit(bucket, face);
            }
        }
    };
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        filling[chunk].resize(buckets);
        for_each_once(chunk, [](Filling& bucket, std::int32_t) { ++bucket.count; });
    });
    std::size_t total = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        first_.push_back(total);
        for (auto& of_chunk : filling) {
            const std::uint32_t own = of_chunk[b].count;
            of_chunk[b] = {static_cast<std::uint32_t>(total), -1};
            total += own;
        }
    }
    first_.push_back(total);
    faces_of_bucket_ = Array<std::int32_t>(total);
    parallel_chunks(chunks, execution, [&](std::size_t chunk) {
        for_each_once(chunk, [&](Filling& bucket, std::int32_t face) {
            faces_of_bucket_[bucket.count++] = face;
        });
        filling[chunk] = {};
    });
}

/// Asks for what will be read of the faces after one, and for what pairing will want to know.
[[gnu::always_inline]] inline void LineBuckets::prefetch_faces(std::size_t number,
                                                               std::size_t end) const {
    const auto far = static_cast<std::size_t>(faces_of_bucket_[std::min(number + 32, end - 1)]);
    prefetch(&faces_.polygons.offsets[far]);
    prefetch(&faces_.plane[far]);
    prefetch(&faces_.above[far]);
    prefetch(&faces_.below[far]);
    const auto near = static_cast<std::size_t>(faces_of_bucket_[std::min(number + 12, end - 1)]);
    prefetch(&faces_.polygons.points[faces_.polygons.offsets[near]]);
    prefetch(&faces_.polygons.lines[faces_.polygons.offsets[near]]);
}

void LineBuckets::collect(std::size_t bucket, const PlanVertices& plan_vertices,
                          BucketEdges& into) const {
    const std::size_t first = first_line(bucket), count_of_lines = first_line(bucket + 1) - first;
    const std::uint32_t* const offsets = faces_.polygons.offsets.begin();
    const auto line_of = [&](std::size_t corner) {
        return std::min(joined_line(corner) - first, count_of_lines);  // huge, where before
    };
    // Counted two further on, these become the ends, and filled up to their ends the beginnings.
    // About every other edge is on a line of another bucket: it is put down, too, behind all
    // others.
    into.offsets_.assign(count_of_lines + 3, 0);
    std::uint32_t* const next = into.offsets_.data();
    for (std::size_t i = first_[bucket]; i < first_[bucket + 1]; ++i) {
        prefetch_faces(i, first_[bucket + 1]);
        const std::size_t face = index(faces_of_bucket_[i]);
        for (std::size_t c = offsets[face], end = offsets[face + 1]; c < end; ++c)
            ++next[line_of(c) + 2];
    }
    for (std::size_t t = 2; t < count_of_lines + 3; ++t)
        next[t] += next[t - 1];
    into.edges_.resize(next[count_of_lines + 2]);
    LineEdge* const edges = into.edges_.begin();
    const PointId* const points = faces_.polygons.points.begin();
    const PlanVertexId* const of_point = plan_vertices.of_point.begin();
    for (std::size_t i = first_[bucket]; i < first_[bucket + 1]; ++i) {
        const std::int32_t face = faces_of_bucket_[i];
        const std::size_t end = offsets[index(face) + 1];
        std::size_t leaving = end - 1;
        PlanVertexId from = of_point[index(points[leaving])];
        for (std::size_t c = offsets[index(face)]; c < end; leaving = c++) {
            const PlanVertexId to = of_point[index(points[c])];
            edges[next[line_of(leaving) + 1]++] = {from, to, static_cast<std::uint32_t>(leaving),
                                                   face};
            from = to;
        }
    }
}

}  // namespace realmodel::strata
