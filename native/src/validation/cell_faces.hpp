// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::validation {

/// A face seen from one of its cells: `face * 2 + side`. From the second cell its loop runs the
/// other way.
using OrientedFace = std::uint32_t;
inline std::size_t face_of(OrientedFace oriented_face) {
    return oriented_face >> 1;
}
inline bool is_reversed(OrientedFace oriented_face) {
    return (oriented_face & 1) != 0;
}

/// The oriented faces of every cell, ascending.
struct FacesByCell : Buckets<OrientedFace> {
    FacesByCell(const ComplexView& model, const Execution& execution);
};

/// The box around a cell.
class CellExtent {
public:
    CellExtent(const ComplexView& model, std::span<const OrientedFace> oriented_faces);

    /// Whether the cell has no extent along an axis.
    bool is_flat() const;
    /// How far rounding its coordinates may have changed its volume.
    double volume_rounding() const;
    std::array<double, 3> middle() const;

private:
    std::array<double, 3> low_, high_;
};

/// An edge of a cell and how often its faces run along it: from `low` to `high`, and back.
struct EdgeCount {
    std::int32_t low = -1, high = -1;
    std::int64_t ahead = 0, back = 0;
};

/// Pairs the edges of one cell: open addressing, emptied at little cost for the next cell. Nothing
/// is asked while edges are entered (whether one is new cannot be foretold); closed() asks all.
class EdgeTable {
public:
    /// Ready for up to `uses` calls of use(). several: an edge may be used more than once each way.
    void reset(std::size_t uses, bool several) {
        several_ = several;
        int bits = 3;  // sparse, since looking twice costs more than room
        while ((std::size_t{1} << bits) <= 2 * uses)
            ++bits;
        shift_ = 64 - bits;
        mask_ = (std::size_t{1} << bits) - 1;
        if (keys_.size() <= mask_) {
            keys_.resize(mask_ + 1);
            uses_.resize(mask_ + 1);
        }
        std::fill_n(keys_.begin(), mask_ + 1, kFree);
        std::fill_n(uses_.begin(), mask_ + 1, 0);
    }

    /// A face runs along the edge from one vertex to another.
    void use(std::int32_t from, std::int32_t to) {
        const std::uint64_t way = from < to ? kAhead : kBack;
        const std::uint64_t key = packed_pair(std::min(from, to), std::max(from, to));
        auto i = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> shift_);
        while (keys_[i] != key && keys_[i] != kFree)
            i = (i + 1) & mask_;
        keys_[i] = key;
        uses_[i] += way;
    }

    /// Whether every edge was used once each way (or as often either way, where several are
    /// allowed).
    bool closed() const {
        bool all = true;
        if (several_) {
            for (std::size_t i = 0; i <= mask_; ++i)
                all &= (uses_[i] >> 32) == (uses_[i] & kAheadMask);
        } else {
            for (std::size_t i = 0; i <= mask_; ++i)
                all &= uses_[i] == 0 || uses_[i] == (kAhead | kBack);
        }
        return all;
    }

    /// Of the edges that were not, the one with the lowest vertices.
    std::optional<EdgeCount> open_edge() const {
        std::optional<EdgeCount> lowest;
        std::uint64_t lowest_key = kFree;
        for (std::size_t i = 0; i <= mask_; ++i) {
            const auto [low, high] = unpacked_pair(keys_[i]);
            const EdgeCount edge{low, high, static_cast<std::int64_t>(uses_[i] & kAheadMask),
                                 static_cast<std::int64_t>(uses_[i] >> 32)};
            const bool fine = edge.ahead == edge.back && (several_ || edge.ahead <= 1);
            if (fine || keys_[i] >= lowest_key) continue;
            lowest_key = keys_[i];
            lowest = edge;
        }
        return lowest;
    }

private:
    static constexpr std::uint64_t kFree = ~std::uint64_t{0};
    static constexpr std::uint64_t kAhead = 1, kBack = std::uint64_t{1} << 32;
    static constexpr std::uint64_t kAheadMask = kBack - 1;

    std::vector<std::uint64_t> keys_;  ///< the edge's low vertex, then its high one
    std::vector<std::uint64_t> uses_;  ///< how often ahead, and in the upper half how often back
    std::size_t mask_ = 0;
    int shift_ = 0;
    bool several_ = false;
};

/// An edge of a cell that is not closed there, or none. One thread, one table for all its cells.
std::optional<EdgeCount> open_edge(const ComplexView& model,
                                   std::span<const OrientedFace> oriented_faces, EdgeTable& table);

/// The same of a cell of many faces, on several threads.
std::optional<EdgeCount> open_edge_of_large_cell(const ComplexView& model,
                                                 std::span<const OrientedFace> oriented_faces,
                                                 const Execution& execution);

}  // namespace realmodel::validation
