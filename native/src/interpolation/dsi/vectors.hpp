// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "base/parallel.hpp"

namespace realmodel::interpolation {

using Vector = std::vector<double>;

inline constexpr std::size_t kVectorPiece = 4096;

/// Calls work(begin, end) for pieces of [0, count). What is short is done before threads have met.
template <class Work>
void in_pieces(std::size_t count, int threads, const Work& work) {
    const std::size_t pieces = (count + kVectorPiece - 1) / kVectorPiece;
    parallel_even(pieces, pieces > 16 ? threads : 1, [&](std::size_t piece) {
        work(piece * kVectorPiece, std::min(count, (piece + 1) * kVectorPiece));
    });
}

/// Calls work(row) for [0, count); each row is work enough for a thread.
template <class Work>
void for_rows(std::size_t count, int threads, const Work& work) {
    parallel_even(count, count > 64 ? threads : 1, work);
}

/// Sums of fixed pieces, added in their order: the same bytes for any number of threads.
inline double dot(std::span<const double> a, std::span<const double> b, int threads) {
    assert(a.size() == b.size());
    std::vector<double> sums((a.size() + kVectorPiece - 1) / kVectorPiece);
    in_pieces(a.size(), threads, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i)
            sum += a[i] * b[i];
        sums[begin / kVectorPiece] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace realmodel::interpolation
