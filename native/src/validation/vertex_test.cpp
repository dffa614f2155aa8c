// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/vertex_test.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <compare>
#include <utility>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "validation/chunked.hpp"

namespace realmodel::validation {

namespace {

/// (vertex, an earlier one at the same position).
using EqualPair = std::pair<std::int32_t, std::int32_t>;

std::uint64_t position_hash(const ComplexView& model, std::int32_t vertex) {
    std::uint64_t hash = 0;
    for (const double coordinate : model.vertex(vertex)) {
        // -0 and 0 are equal
        hash += std::bit_cast<std::uint64_t>(coordinate == 0.0 ? 0.0 : coordinate);
        hash *= 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return hash * 0xBF58476D1CE4E5B9u;
}

/// How many vertices ascend before one does not.
std::size_t count_ascending(const ComplexView& model, const Execution& execution) {
    std::atomic<std::size_t> ascending{model.vertex_count()};
    parallel_ranges(model.vertex_count(), kItemsOfChunk, execution,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t v = std::max<std::size_t>(begin, 1); v < end; ++v) {
                            if (model.vertex(static_cast<std::int32_t>(v - 1)) <
                                model.vertex(static_cast<std::int32_t>(v)))
                                continue;
                            std::size_t least = ascending.load();
                            while (v < least && !ascending.compare_exchange_weak(least, v)) {
                            }
                            return;
                        }
                    });
    return ascending;
}

/// Whether all vertices are distinct, as the builder's own are, which ascend, and few others behind
/// them. Where they are not in this order it says no: then they are compared by a hash of their
/// positions.
bool are_distinct_in_order(const ComplexView& model, const Execution& execution) {
    constexpr std::size_t kFew = 64;  // at most one in so many behind
    const std::size_t ascending = count_ascending(model, execution);
    std::vector<std::array<double, 3>> behind;
    if (model.vertex_count() - ascending > ascending / kFew) return false;
    for (std::size_t v = ascending; v < model.vertex_count(); ++v) {
        behind.push_back(model.vertex(static_cast<std::int32_t>(v)));
        for (const double coordinate : behind.back()) {
            if (!std::isfinite(coordinate)) return false;
        }
    }
    std::sort(behind.begin(), behind.end());
    if (std::adjacent_find(behind.begin(), behind.end()) != behind.end()) return false;
    return std::none_of(behind.begin(), behind.end(), [&](const auto& place) {
        std::size_t low = 0, high = ascending;
        while (low < high) {
            const std::size_t middle = low + (high - low) / 2;
            const auto there = model.vertex(static_cast<std::int32_t>(middle));
            if (there == place) return true;
            (there < place ? low : high) = there < place ? middle + 1 : middle;
        }
        return false;
    });
}

/// A vertex with the hash of its position.
struct HashedVertex {
    std::uint32_t hash;
    std::int32_t vertex;
    friend auto operator<=>(const HashedVertex&, const HashedVertex&) = default;
};

/// Vertices in buckets by a hash of their positions; equal ones are in one bucket.
Buckets<HashedVertex> position_buckets(const ComplexView& model, const Execution& execution) {
    constexpr std::size_t kVerticesOfBucket = 4096, kMost = std::size_t{1} << 16;
    const std::size_t count = model.vertex_count();
    const std::size_t buckets = std::min(kMost, std::bit_ceil(count / kVerticesOfBucket + 1));
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(count, (chunk + 1) * kItemsOfChunk);
        for (std::size_t i = chunk * kItemsOfChunk; i < end; ++i) {
            const auto v = static_cast<std::int32_t>(i);
            const std::uint64_t hash = position_hash(model, v);
            put(hash & (buckets - 1), HashedVertex{static_cast<std::uint32_t>(hash >> 32), v});
        }
    };
    const std::size_t chunks = (count + kItemsOfChunk - 1) / kItemsOfChunk;
    return bucketize_in_order<HashedVertex>(buckets, chunks, produce, execution);
}

/// Of each position that several vertices of a bucket have, all but the first with the one before.
std::vector<EqualPair> equal_pairs(const ComplexView& model, std::span<HashedVertex> bucket) {
    std::sort(bucket.begin(), bucket.end());
    std::vector<EqualPair> pairs;
    for (std::size_t i = 0; i < bucket.size(); ++i) {
        const auto [hash, v] = bucket[i];
        for (std::size_t j = i; j > 0 && bucket[j - 1].hash == hash; --j) {
            const std::int32_t earlier = bucket[j - 1].vertex;
            if (model.vertex(earlier) != model.vertex(v)) continue;
            pairs.emplace_back(v, earlier);
            break;
        }
    }
    return pairs;
}

Findings check_distinct(const ComplexView& model, const Execution& execution) {
    if (are_distinct_in_order(model, execution)) return {};
    auto buckets = position_buckets(model, execution);
    std::vector<std::vector<EqualPair>> pairs(buckets.size());
    parallel_chunks(buckets.size(), execution,
                    [&](std::size_t b) { pairs[b] = equal_pairs(model, buckets[b]); });
    std::vector<EqualPair> all;
    for (const auto& part : pairs)
        all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end());
    Findings found;
    for (const EqualPair& pair : all) {
        found.fail([&, pair] {
            const auto& [v, earlier] = pair;
            return Offender{.text = "vertex " + std::to_string(v) +
                                    " has the coordinates of vertex " + std::to_string(earlier),
                            .vertex = v,
                            .place = model.vertex(v)};
        });
    }
    return found;
}

Findings check_used(const ComplexView& model, const Execution& execution) {
    std::vector<std::uint8_t> used(model.vertex_count(), 0);
    parallel_each(model.face_vertices.size(), execution,
                  [&](std::size_t i) { mark(used[index(model.face_vertices[i])]); });
    Findings found;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] != 0) continue;
        const auto vertex = static_cast<std::int32_t>(v);
        found.fail([&] {
            return Offender{.text = "vertex " + std::to_string(v) + " belongs to no face",
                            .vertex = vertex,
                            .place = model.vertex(vertex)};
        });
    }
    return found;
}

/// A vertex that a loop names twice, or -1.
std::int32_t repeated_vertex(std::span<const std::int32_t> loop) {
    constexpr std::size_t kFew = 12;
    if (loop.size() <= kFew) {
        for (std::size_t i = 1; i < loop.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (loop[i] == loop[j]) return loop[i];
            }
        }
        return -1;
    }
    std::vector<std::int32_t> sorted(loop.begin(), loop.end());
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    return twice == sorted.end() ? -1 : *twice;
}

}  // namespace

Findings check_vertices(const ComplexView& model, const Execution& execution) {
    Findings found = check_distinct(model, execution);
    found.append(check_used(model, execution));
    found.examined = static_cast<std::int64_t>(model.vertex_count());
    return found;
}

Findings check_loops(const ComplexView& model, const Execution& execution) {
    Findings found = look_at_each(model.face_count(), execution, [&](std::size_t f, Findings& own) {
        const std::int32_t v = repeated_vertex(model.face(f));
        if (v < 0) return;
        own.fail([&] {
            return Offender{.text = "face " + std::to_string(f) + " passes vertex " +
                                    std::to_string(v) + " more than once",
                            .cell = model.cell(f, 0),
                            .face = static_cast<std::int64_t>(f),
                            .vertex = v,
                            .place = model.vertex(v)};
        });
    });
    found.examined = static_cast<std::int64_t>(model.face_count());
    return found;
}

}  // namespace realmodel::validation
