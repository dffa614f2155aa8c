// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/closed_cells.hpp"

#include <algorithm>
#include <array>
#include <vector>

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
    const auto loop = model.corners(face_of(side));
    std::int32_t before = loop.back();
    if (is_turned(side)) {
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

/// The edges of a large cell dealt out to buckets that fit the cache, each edge with all its uses
/// in one of them.
class EdgeBuckets {
public:
    EdgeBuckets(const ComplexView& model, std::span<const Side> sides, int threads,
                const Progress* progress) {
        std::size_t uses = 0;
        for (const Side side : sides)
            uses += model.corners(face_of(side)).size();
        while (bits_ < 16 && (kUsesOfBucket << bits_) < uses)
            ++bits_;
        const std::size_t chunks = (sides.size() + kItemsOfChunk - 1) / kItemsOfChunk;
        std::vector<std::size_t> next(chunks << bits_, 0);
        const auto in_chunk = [&](std::size_t chunk, const auto& visit) {
            const std::size_t end = std::min(sides.size(), (chunk + 1) * kItemsOfChunk);
            for (std::size_t i = chunk * kItemsOfChunk; i < end; ++i)
                along_loop(model, sides[i], visit);
        };
        parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
            std::size_t* const count = &next[chunk << bits_];
            in_chunk(chunk, [&](std::int32_t from, std::int32_t to) { ++count[bucket(from, to)]; });
        });
        std::size_t total = 0;
        for (std::size_t b = 0; b < size(); ++b) {
            for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
                std::size_t& entry = next[(chunk << bits_) + b];
                total += std::exchange(entry, total);
            }
            end_.push_back(total);
        }
        edges_.resize(total);
        parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
            std::size_t* const at = &next[chunk << bits_];
            in_chunk(chunk, [&](std::int32_t from, std::int32_t to) {
                edges_[at[bucket(from, to)]++] = {from, to};
            });
        });
    }

    std::size_t size() const { return std::size_t{1} << bits_; }
    std::span<const DirectedEdge> operator[](std::size_t b) const {
        const std::size_t begin = b == 0 ? 0 : end_[b - 1];
        return {edges_.data() + begin, end_[b] - begin};
    }

private:
    static constexpr std::size_t kUsesOfBucket = 8192;

    // not the hash of EdgeTable, or a bucket would fill one part of its table
    std::size_t bucket(std::int32_t from, std::int32_t to) const {
        const auto low = static_cast<std::uint32_t>(std::min(from, to));
        return static_cast<std::size_t>((low * std::uint64_t{0xD1B54A32D192ED03u}) >> 40) &
               (size() - 1);
    }

    int bits_ = 0;
    std::vector<std::size_t> end_;
    std::vector<DirectedEdge> edges_;
};

}  // namespace

std::optional<EdgeUse> open_edge(const ComplexView& model, std::span<const Side> sides,
                                 EdgeTable& table) {
    std::size_t uses = 0;
    for (const Side side : sides)
        uses += model.corners(face_of(side)).size();
    table.reset(uses, model.cells_are_blocks);
    for (const Side side : sides) {
        along_loop(model, side, [&](std::int32_t from, std::int32_t to) { table.use(from, to); });
    }
    return table.closed() ? std::nullopt : table.open_edge();
}

std::optional<EdgeUse> open_edge_of_large_cell(const ComplexView& model,
                                               std::span<const Side> sides, int threads,
                                               const Progress* progress) {
    const EdgeBuckets buckets(model, sides, threads, progress);
    std::vector<std::optional<EdgeUse>> open(buckets.size());
    parallel_chunks(buckets.size(), threads, progress, [&](std::size_t b) {
        EdgeTable table;
        table.reset(buckets[b].size(), model.cells_are_blocks);
        for (const auto& [from, to] : buckets[b])
            table.use(from, to);
        if (!table.closed()) open[b] = table.open_edge();
    });
    std::optional<EdgeUse> lowest;
    for (const auto& e : open) {
        if (e && (!lowest || std::pair(e->low, e->high) < std::pair(lowest->low, lowest->high)))
            lowest = e;
    }
    return lowest;
}

}  // namespace realmodel::validation
