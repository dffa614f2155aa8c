// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/array_tests.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel_counts.hpp"
#include "base/parallel_sort.hpp"
#include "realmodel/strata/stack.hpp"
#include "validation/findings.hpp"

namespace realmodel::validation {

namespace {

std::string number(std::int64_t value) {
    return std::to_string(value);
}

Findings check_lengths(const ComplexView& m) {
    Findings flaws;
    const auto fail = [&](std::string text) { flaws.fail([&] { return Offender{.text = text}; }); };
    constexpr auto kLargest = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    const std::size_t faces = m.face_count();
    if (m.vertices.size() % 3 != 0) fail("the coordinates are not in threes");
    if (m.face_cells.size() != 2 * faces || m.face_surface.size() != faces)
        fail("face_cells has not two cells for each face, or face_surface not one surface");
    if (m.face_offsets.size() != faces + 1) {
        fail("face_offsets has " + std::to_string(m.face_offsets.size()) + " entries for " +
             std::to_string(faces) + " faces");
    } else if (m.face_offsets.front() != 0 ||
               m.face_offsets.back() != static_cast<std::int64_t>(m.face_vertices.size())) {
        fail("face_offsets does not run from 0 to the number of corners");
    }
    if (m.block_volume.size() != m.blocks ||
        (!m.block_base.empty() && m.block_base.size() != m.blocks))
        fail("blocks without a volume or base");
    if (2 * faces > kLargest || m.vertex_count() > kLargest || m.cell_count() > kLargest)
        fail("there are more faces, vertices or cells than 32-bit numbers can name");
    return flaws;
}

void check_face(const ComplexView& m, std::size_t f, std::vector<std::uint8_t>& has_face,
                Findings& findings) {
    const auto face = static_cast<std::int64_t>(f);
    const auto fail = [&](const auto& text) {
        findings.fail([&] { return Offender{.text = text(), .face = face}; });
    };
    const std::int64_t begin = m.face_offsets[f], end = m.face_offsets[f + 1];
    const auto corners = static_cast<std::int64_t>(m.face_vertices.size());
    if (begin < 0 || end > corners || end - begin < 3) {
        fail([&] { return "face " + number(face) + " has " + number(end - begin) + " corners"; });
        return;
    }
    for (const std::int32_t v : m.face(f)) {
        if (v >= 0 && static_cast<std::size_t>(v) < m.vertex_count()) continue;
        fail([&] { return "face " + number(face) + " names vertex " + number(v); });
        return;
    }
    const std::int32_t first = m.cell(f, 0), second = m.cell(f, 1);
    const auto cells = static_cast<std::int64_t>(m.cell_count());
    if (first < 0 || first >= cells || second < -1 || second >= cells || first == second) {
        fail([&] {
            return "face " + number(face) + " lies between cells " + number(first) + " and " +
                   number(second);
        });
        return;
    }
    for (const std::int32_t cell : {first, second}) {
        if (cell >= 0) atomic_set(has_face[index(cell)]);
    }
    if (m.face_surface[f] < kCutFace || m.face_surface[f] >= m.surfaces) {
        fail(
            [&] { return "face " + number(face) + " names surface " + number(m.face_surface[f]); });
    }
}

void check_cell(const ComplexView& m, std::size_t c, const std::vector<std::uint8_t>& has_face,
                Findings& findings) {
    const auto cell = static_cast<std::int64_t>(c);
    const std::int32_t block = m.cell_block[c];
    if (block < 0 || static_cast<std::size_t>(block) >= m.blocks) {
        findings.fail([&] {
            return Offender{.text = "cell " + number(cell) + " names block " + number(block),
                            .cell = cell};
        });
    } else if (has_face[c] == 0) {
        findings.fail([&] {
            return Offender{.text = "cell " + number(cell) + " has no faces", .cell = cell};
        });
    }
}

void check_vertex(const ComplexView& m, std::size_t v, Findings& findings) {
    const auto position = m.vertex(static_cast<std::int32_t>(v));
    if (std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(position[2]))
        return;
    const auto vertex = static_cast<std::int64_t>(v);
    findings.fail([&] {
        return Offender{.text = "vertex " + number(vertex) + " is not finite", .vertex = vertex};
    });
}

}  // namespace

Findings check_arrays(const ComplexView& m, const Execution& execution) {
    Findings findings = check_lengths(m);
    if (!findings.passed()) return findings;
    std::vector<std::uint8_t> has_face(m.cell_count(), 0);
    const auto face = [&](std::size_t f, Findings& flaws) { check_face(m, f, has_face, flaws); };
    const auto cell = [&](std::size_t c, Findings& flaws) { check_cell(m, c, has_face, flaws); };
    const auto vertex = [&](std::size_t v, Findings& flaws) { check_vertex(m, v, flaws); };
    findings = examine_all(m.face_count(), execution, face);
    findings.append(examine_all(m.cell_count(), execution, cell));
    findings.append(examine_all(m.vertex_count(), execution, vertex));
    findings.examined = static_cast<std::int64_t>(m.face_count());
    return findings;
}

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
    std::size_t ascending = model.vertex_count();
    parallel_ranges(model.vertex_count(), kItemsOfChunk, execution,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t v = std::max<std::size_t>(begin, 1); v < end; ++v) {
                            if (model.vertex(static_cast<std::int32_t>(v - 1)) <
                                model.vertex(static_cast<std::int32_t>(v)))
                                continue;
                            atomic_min_by(ascending, v, std::less<>());
                            return;
                        }
                    });
    return ascending;
}

/// Whether all vertices are distinct, as the builder's own are, which ascend, and few others behind
/// them. Where they are not in this order it says no: then they are compared by a hash of their
/// positions.
bool are_distinct_in_order(const ComplexView& model, const Execution& execution) {
    constexpr std::size_t kAscendingOfOne = 64;  // to one behind, at least
    const std::size_t ascending = count_ascending(model, execution);
    std::vector<std::array<double, 3>> behind;
    if (model.vertex_count() - ascending > ascending / kAscendingOfOne) return false;
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
            const auto position = model.vertex(static_cast<std::int32_t>(middle));
            if (position == place) return true;
            (position < place ? low : high) = position < place ? middle + 1 : middle;
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
    constexpr std::size_t kVerticesOfBucket = 4096, kMaxBuckets = std::size_t{1} << 16;
    const std::size_t count = model.vertex_count();
    const std::size_t buckets = std::min(kMaxBuckets, std::bit_ceil(count / kVerticesOfBucket + 1));
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
    std::vector<EqualPair> all = concatenated(pairs);
    std::sort(all.begin(), all.end());
    Findings findings;
    for (const EqualPair& pair : all) {
        findings.fail([&, pair] {
            const auto& [v, earlier] = pair;
            return Offender{.text = "vertex " + std::to_string(v) +
                                    " has the coordinates of vertex " + std::to_string(earlier),
                            .vertex = v,
                            .place = model.vertex(v)};
        });
    }
    return findings;
}

Findings check_used(const ComplexView& model, const Execution& execution) {
    std::vector<std::uint8_t> used(model.vertex_count(), 0);
    parallel_for_each(model.face_vertices.size(), execution,
                      [&](std::size_t i) { atomic_set(used[index(model.face_vertices[i])]); });
    Findings findings;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] != 0) continue;
        const auto vertex = static_cast<std::int32_t>(v);
        findings.fail([&] {
            return Offender{.text = "vertex " + std::to_string(v) + " belongs to no face",
                            .vertex = vertex,
                            .place = model.vertex(vertex)};
        });
    }
    return findings;
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
    Findings findings = check_distinct(model, execution);
    findings.append(check_used(model, execution));
    findings.examined = static_cast<std::int64_t>(model.vertex_count());
    return findings;
}

Findings check_loops(const ComplexView& model, const Execution& execution) {
    Findings all = examine_all(model.face_count(), execution, [&](std::size_t f, Findings& flaws) {
        const std::int32_t v = repeated_vertex(model.face(f));
        if (v < 0) return;
        flaws.fail([&] {
            return Offender{.text = "face " + std::to_string(f) + " passes vertex " +
                                    std::to_string(v) + " more than once",
                            .cell = model.cell(f, 0),
                            .face = static_cast<std::int64_t>(f),
                            .vertex = v,
                            .place = model.vertex(v)};
        });
    });
    all.examined = static_cast<std::int64_t>(model.face_count());
    return all;
}

namespace {

struct OuterFace {
    std::uint64_t corners;  ///< the same for faces of the same corners, in whatever order
    std::int32_t face;
    friend bool operator<(const OuterFace& a, const OuterFace& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.face < b.face;
    }
};

std::uint64_t corners_in_any_order(std::span<const std::int32_t> loop) {
    std::uint64_t sum = loop.size();
    for (const std::int32_t v : loop) {
        std::uint64_t h = (static_cast<std::uint64_t>(v) + 1) * 0x9E3779B97F4A7C15u;
        h ^= h >> 29;
        sum += h * 0xBF58476D1CE4E5B9u;
    }
    return sum;
}

bool same_corners(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
    std::vector<std::int32_t> one(a.begin(), a.end()), other(b.begin(), b.end());
    std::sort(one.begin(), one.end());
    std::sort(other.begin(), other.end());
    return one == other;
}

}  // namespace

Findings check_outside(const ComplexView& model, const Execution& execution) {
    std::vector<OuterFace> outer;
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(execution.progress, f);
        if (model.cell(f, 1) < 0)
            outer.push_back({corners_in_any_order(model.face(f)), static_cast<std::int32_t>(f)});
    }
    parallel_sort(outer, std::less<>(), execution);
    Findings findings;
    findings.examined = static_cast<std::int64_t>(outer.size());
    for (std::size_t i = 1; i < outer.size(); ++i) {
        if (outer[i].corners != outer[i - 1].corners) continue;
        const auto one = static_cast<std::size_t>(outer[i - 1].face);
        const auto other = static_cast<std::size_t>(outer[i].face);
        if (!same_corners(model.face(one), model.face(other))) continue;
        findings.fail([&] {
            return Offender{.text = "face " + std::to_string(other) + " has one cell, but face " +
                                    std::to_string(one) + " of cell " +
                                    std::to_string(model.cell(one, 0)) +
                                    " lies at the same position",
                            .cell = model.cell(other, 0),
                            .face = static_cast<std::int64_t>(other),
                            .place = model.vertex(model.face(other)[0])};
        });
    }
    return findings;
}

}  // namespace realmodel::validation
