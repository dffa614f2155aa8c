// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/closed_cells.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "base/counting_sort.hpp"
#include "validation/chunked.hpp"

namespace realmodel::validation {

namespace {

/// An edge as a face runs along it.
struct DirectedEdge {
    std::int32_t from, to;
};

/// Calls visit(from, to) along the loop of a face as its cell has it.
template <class Visit>
void along_loop(const ComplexView& model, Side side, const Visit& visit) {
    const auto loop = model.face(face_of(side));
    std::int32_t before = loop.back();
    if (is_reversed(side)) {
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

std::size_t count_edges(const ComplexView& model, std::span<const Side> sides) {
    std::size_t edges = 0;
    for (const Side side : sides)
        edges += model.face(face_of(side)).size();
    return edges;
}

/// The edges of a large cell in buckets that fit the cache, each edge with all its uses in one.
Buckets<DirectedEdge> edge_buckets(const ComplexView& model, std::span<const Side> sides,
                                   const Execution& execution) {
    constexpr std::size_t kUsesOfBucket = 8192, kMost = std::size_t{1} << 16;
    const std::size_t buckets =
        std::min(kMost, std::bit_ceil(count_edges(model, sides) / kUsesOfBucket + 1));
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(sides.size(), (chunk + 1) * kItemsOfChunk);
        for (std::size_t i = chunk * kItemsOfChunk; i < end; ++i) {
            along_loop(model, sides[i], [&](std::int32_t from, std::int32_t to) {
                // not the hash of EdgeTable, or a bucket would fill one part of its table
                const auto low = static_cast<std::uint32_t>(std::min(from, to));
                const std::uint64_t hash = low * std::uint64_t{0xD1B54A32D192ED03u};
                put(static_cast<std::size_t>(hash >> 40) & (buckets - 1), DirectedEdge{from, to});
            });
        }
    };
    const std::size_t chunks = (sides.size() + kItemsOfChunk - 1) / kItemsOfChunk;
    return bucketize_in_order<DirectedEdge>(buckets, chunks, produce, execution);
}

}  // namespace

std::optional<EdgeCount> open_edge(const ComplexView& model, std::span<const Side> sides,
                                   EdgeTable& table) {
    table.reset(count_edges(model, sides), model.cell_kind == CellKind::kBlocks);
    for (const Side side : sides) {
        along_loop(model, side, [&](std::int32_t from, std::int32_t to) { table.use(from, to); });
    }
    return table.closed() ? std::nullopt : table.open_edge();
}

std::optional<EdgeCount> open_edge_of_large_cell(const ComplexView& model,
                                                 std::span<const Side> sides,
                                                 const Execution& execution) {
    const auto buckets = edge_buckets(model, sides, execution);
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
