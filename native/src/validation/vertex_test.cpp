// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/vertex_test.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>
#include <vector>

#include "validation/chunked.hpp"

namespace realmodel::validation {

namespace {

/// (vertex, an earlier one in the same place).
using EqualPair = std::pair<std::int32_t, std::int32_t>;

std::uint64_t position_hash(const ComplexView& model, std::int32_t vertex) {
    std::uint64_t hash = 0;
    for (const double coordinate : model.position(vertex)) {
        // -0 and 0 are one place
        hash += std::bit_cast<std::uint64_t>(coordinate == 0.0 ? 0.0 : coordinate);
        hash *= 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return hash * 0xBF58476D1CE4E5B9u;
}

/// The builder's own vertices ascend, which says all; others are dealt out by a hash of their
/// place.
bool ascends(const ComplexView& model, int threads, const Progress* progress) {
    std::atomic<bool> broken{false};
    in_chunks(model.vertex_count(), threads, progress,
              [&](std::size_t begin, std::size_t end, Findings&) {
                  if (broken.load(std::memory_order_relaxed)) return;
                  for (std::size_t v = std::max<std::size_t>(begin, 1); v < end; ++v) {
                      if (model.position(static_cast<std::int32_t>(v - 1)) <
                          model.position(static_cast<std::int32_t>(v)))
                          continue;
                      broken.store(true, std::memory_order_relaxed);
                      return;
                  }
              });
    return !broken;
}

/// Vertices dealt out by a hash of their place; those in one place are in one bucket.
class PlaceBuckets {
public:
    PlaceBuckets(const ComplexView& model, int threads, const Progress* progress) {
        const std::size_t count = model.vertex_count();
        while (bits_ < 16 && (kVerticesOfBucket << bits_) < count)
            ++bits_;
        const std::size_t chunks = (count + kItemsOfChunk - 1) / kItemsOfChunk;
        std::vector<std::size_t> next(chunks << bits_, 0);
        const auto in_chunk = [&](std::size_t chunk, const auto& visit) {
            const std::size_t end = std::min(count, (chunk + 1) * kItemsOfChunk);
            for (std::size_t v = chunk * kItemsOfChunk; v < end; ++v) {
                const std::uint64_t hash = position_hash(model, static_cast<std::int32_t>(v));
                visit(static_cast<std::int32_t>(v), (chunk << bits_) + bucket(hash),
                      static_cast<std::uint32_t>(hash >> 32));
            }
        };
        parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
            in_chunk(chunk, [&](std::int32_t, std::size_t at, std::uint32_t) { ++next[at]; });
        });
        std::size_t total = 0;
        for (std::size_t b = 0; b < size(); ++b) {
            for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
                total += std::exchange(next[(chunk << bits_) + b], total);
            }
            end_.push_back(total);
        }
        entries_.resize(total);
        parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
            in_chunk(chunk, [&](std::int32_t v, std::size_t at, std::uint32_t hash) {
                entries_[next[at]++] = {hash, v};
            });
        });
    }

    std::size_t size() const { return std::size_t{1} << bits_; }

    /// Of each place in a bucket that has several vertices, the later ones with the first.
    std::vector<EqualPair> equal_pairs(const ComplexView& model, std::size_t b) {
        const auto at = [&](std::size_t i) {
            return entries_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        const std::size_t begin = b == 0 ? 0 : end_[b - 1], end = end_[b];
        std::sort(at(begin), at(end));
        std::vector<EqualPair> pairs;
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t j = i; j > begin && entries_[j - 1].first == entries_[i].first; --j) {
                const std::int32_t earlier = entries_[j - 1].second, v = entries_[i].second;
                if (model.position(earlier) != model.position(v)) continue;
                pairs.emplace_back(v, earlier);
                break;
            }
        }
        return pairs;
    }

private:
    static constexpr std::size_t kVerticesOfBucket = 4096;
    std::size_t bucket(std::uint64_t hash) const { return hash & (size() - 1); }

    int bits_ = 0;
    std::vector<std::size_t> end_;
    std::vector<std::pair<std::uint32_t, std::int32_t>> entries_;  ///< hash and vertex
};

Findings check_distinct(const ComplexView& model, int threads, const Progress* progress) {
    if (ascends(model, threads, progress)) return {};
    PlaceBuckets buckets(model, threads, progress);
    std::vector<std::vector<EqualPair>> pairs(buckets.size());
    parallel_chunks(buckets.size(), threads, progress,
                    [&](std::size_t b) { pairs[b] = buckets.equal_pairs(model, b); });
    std::vector<EqualPair> all;
    for (const auto& part : pairs)
        all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end());
    Findings found;
    for (const auto& [v, earlier] : all) {
        found.fail([&, v = v, earlier = earlier] {
            return Offender{.text = "vertex " + std::to_string(v) + " is in the place of vertex " +
                                    std::to_string(earlier),
                            .vertex = v,
                            .place = model.position(v)};
        });
    }
    return found;
}

Findings check_used(const ComplexView& model, int threads, const Progress* progress) {
    std::vector<std::uint8_t> used(model.vertex_count(), 0);
    in_chunks(model.face_vertices.size(), threads, progress,
              [&](std::size_t begin, std::size_t end, Findings&) {
                  // threads may say so at once; they all write the same
                  for (std::size_t i = begin; i < end; ++i) {
                      std::atomic_ref<std::uint8_t>(
                          used[static_cast<std::size_t>(model.face_vertices[i])])
                          .store(1, std::memory_order_relaxed);
                  }
              });
    Findings found;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] != 0) continue;
        const auto vertex = static_cast<std::int32_t>(v);
        found.fail([&] {
            return Offender{.text = "vertex " + std::to_string(v) + " belongs to no face",
                            .vertex = vertex,
                            .place = model.position(vertex)};
        });
    }
    return found;
}

/// A vertex that a loop names twice, or -1.
std::int32_t repeated_vertex(std::span<const std::int32_t> loop,
                             std::vector<std::int32_t>& sorted) {
    constexpr std::size_t kFew = 12;
    if (loop.size() <= kFew) {
        for (std::size_t i = 1; i < loop.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (loop[i] == loop[j]) return loop[i];
            }
        }
        return -1;
    }
    sorted.assign(loop.begin(), loop.end());
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    return twice == sorted.end() ? -1 : *twice;
}

}  // namespace

Findings check_vertices(const ComplexView& model, int threads, const Progress* progress) {
    Findings found = check_distinct(model, threads, progress);
    found.append(check_used(model, threads, progress));
    found.examined = static_cast<std::int64_t>(model.vertex_count());
    return found;
}

Findings check_loops(const ComplexView& model, int threads, const Progress* progress) {
    Findings found = in_chunks(
        model.face_count(), threads, progress,
        [&](std::size_t begin, std::size_t end, Findings& own) {
            std::vector<std::int32_t> sorted;
            for (std::size_t f = begin; f < end; ++f) {
                const std::int32_t v = repeated_vertex(model.corners(f), sorted);
                if (v < 0) continue;
                own.fail([&] {
                    return Offender{.text = "face " + std::to_string(f) + " passes vertex " +
                                            std::to_string(v) + " more than once",
                                    .cell = model.cell(f, 0),
                                    .face = static_cast<std::int64_t>(f),
                                    .vertex = v,
                                    .place = model.position(v)};
                });
            }
        });
    found.examined = static_cast<std::int64_t>(model.face_count());
    return found;
}

}  // namespace realmodel::validation
