// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_faces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "validation/face_shape.hpp"
#include "validation/findings.hpp"

namespace realmodel::validation {

FacesByCell::FacesByCell(const ComplexView& model, const Execution& execution) {
    const std::size_t oriented_faces = model.face_cells.size(), cells = model.cell_count();
    const auto produce = [&](std::size_t chunk, const auto& put) {
        for (std::size_t i = chunk * kItemsOfChunk,
                         end = std::min(oriented_faces, i + kItemsOfChunk);
             i < end; ++i) {
            const std::int32_t cell = model.face_cells[i];
            if (cell >= 0) put(index(cell), static_cast<OrientedFace>(i));
        }
    };
    const std::size_t chunks = (oriented_faces + kItemsOfChunk - 1) / kItemsOfChunk;
    Buckets<OrientedFace>::operator=(
        sorted_in_buckets<OrientedFace>(cells, chunks, produce, execution));
}

CellExtent::CellExtent(const ComplexView& model, std::span<const OrientedFace> oriented_faces) {
    low_.fill(HUGE_VAL);
    high_.fill(-HUGE_VAL);
    for (const OrientedFace oriented_face : oriented_faces) {
        for (const std::int32_t v : model.face(face_of(oriented_face))) {
            const auto p = model.vertex(v);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low_[axis] = std::min(low_[axis], p[axis]);
                high_[axis] = std::max(high_[axis], p[axis]);
            }
        }
    }
}

bool CellExtent::is_flat() const {
    return low_[0] == high_[0] || low_[1] == high_[1] || low_[2] == high_[2];
}

// What moves by a step in x sweeps no more than the cell is wide in y and high in z, and so on.
double CellExtent::volume_rounding() const {
    std::array<double, 3> size, step;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        step[axis] = last_place(std::max(std::abs(low_[axis]), std::abs(high_[axis])));
        size[axis] = high_[axis] - low_[axis] + step[axis];
    }
    return kRoundingSteps * (step[0] * size[1] * size[2] + size[0] * step[1] * size[2] +
                             size[0] * size[1] * step[2]) +
           0x1p-1000;  // what underflows
}

std::array<double, 3> CellExtent::middle() const {
    return {low_[0] + (high_[0] - low_[0]) / 2, low_[1] + (high_[1] - low_[1]) / 2,
            low_[2] + (high_[2] - low_[2]) / 2};
}

namespace {

/// An edge as a face runs along it.
struct LoopEdge {
    std::int32_t from, to;
};

/// Calls visit(from, to) along the loop of a face as its cell has it.
template <class Visit>
void along_loop(const ComplexView& model, OrientedFace oriented_face, const Visit& visit) {
    const auto loop = model.face(face_of(oriented_face));
    std::int32_t before = loop.back();
    if (is_reversed(oriented_face)) {
        for (const std::int32_t v : loop) {
            visit(v, before);
            before = v;
        }
    } else {
        for (const std::int32_t v : loop) {
            visit(before, v);
            before = v;
        }
    }
}

std::size_t count_edges(const ComplexView& model, std::span<const OrientedFace> oriented_faces) {
    std::size_t edges = 0;
    for (const OrientedFace oriented_face : oriented_faces)
        edges += model.face(face_of(oriented_face)).size();
    return edges;
}

/// The edges of a large cell in buckets that fit the cache, each edge with all its uses in one.
Buckets<LoopEdge> edge_buckets(const ComplexView& model,
                               std::span<const OrientedFace> oriented_faces,
                               const Execution& execution) {
    constexpr std::size_t kUsesOfBucket = 8192, kMaxBuckets = std::size_t{1} << 16;
    const std::size_t buckets = std::min(
        kMaxBuckets, std::bit_ceil(count_edges(model, oriented_faces) / kUsesOfBucket + 1));
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(oriented_faces.size(), (chunk + 1) * kItemsOfChunk);
        for (std::size_t i = chunk * kItemsOfChunk; i < end; ++i) {
            along_loop(model, oriented_faces[i], [&](std::int32_t from, std::int32_t to) {
                // not the hash of EdgeTable, or a bucket would fill one part of its table
                const auto low = static_cast<std::uint32_t>(std::min(from, to));
                const std::uint64_t hash = low * std::uint64_t{0xD1B54A32D192ED03u};
                put(static_cast<std::size_t>(hash >> 40) & (buckets - 1), LoopEdge{from, to});
            });
        }
    };
    const std::size_t chunks = (oriented_faces.size() + kItemsOfChunk - 1) / kItemsOfChunk;
    return bucketize_in_order<LoopEdge>(buckets, chunks, produce, execution);
}

}  // namespace

std::optional<EdgeCount> open_edge(const ComplexView& model,
                                   std::span<const OrientedFace> oriented_faces, EdgeTable& table) {
    table.reset(count_edges(model, oriented_faces), model.cell_kind == CellKind::kBlocks);
    for (const OrientedFace oriented_face : oriented_faces) {
        along_loop(model, oriented_face,
                   [&](std::int32_t from, std::int32_t to) { table.use(from, to); });
    }
    return table.closed() ? std::nullopt : table.open_edge();
}

std::optional<EdgeCount> open_edge_of_large_cell(const ComplexView& model,
                                                 std::span<const OrientedFace> oriented_faces,
                                                 const Execution& execution) {
    const auto buckets = edge_buckets(model, oriented_faces, execution);
    std::vector<std::optional<EdgeCount>> open(buckets.size());
    parallel_chunks(buckets.size(), execution, [&](std::size_t b) {
        EdgeTable table;
        table.reset(buckets[b].size(), model.cell_kind == CellKind::kBlocks);
        for (const auto& [from, to] : buckets[b])
            table.use(from, to);
        if (!table.closed()) open[b] = table.open_edge();
    });
    std::optional<EdgeCount> lowest;
    for (const auto& e : open) {
        if (e && (!lowest || std::pair(e->low, e->high) < std::pair(lowest->low, lowest->high)))
            lowest = e;
    }
    return lowest;
}

}  // namespace realmodel::validation
