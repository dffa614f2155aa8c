// SPDX-License-Identifier: GPL-3.0-or-later
// Long vectors by several threads, the same bytes for any number of them. Private.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "interpolation/node_loop.hpp"

namespace realmodel::interpolation {

using Vector = std::vector<double>;

/// Calls work(begin, end) for pieces of [0, count); work must not throw.
template <class Work>
void in_pieces(std::size_t count, int threads, Work&& work) {
    constexpr std::size_t piece = 4096;
    const auto pieces = static_cast<std::ptrdiff_t>((count + piece - 1) / piece);
#pragma omp parallel for schedule(static) num_threads(threads) if (pieces > 16)
    for (std::ptrdiff_t p = 0; p < pieces; ++p) {
        const std::size_t begin = static_cast<std::size_t>(p) * piece;
        work(begin, std::min(begin + piece, count));
    }
}

/// Calls work(row) for [0, count), of rows that are work enough each; work must not throw.
template <class Work>
void for_rows(std::size_t count, int threads, Work&& work) {
    const auto rows = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for schedule(static) num_threads(threads) if (rows > 64)
    for (std::ptrdiff_t row = 0; row < rows; ++row)
        work(static_cast<std::size_t>(row));
}

/// Sums of fixed pieces, added in their order.
inline double dot(std::span<const double> a, std::span<const double> b, int threads) {
    constexpr std::size_t piece = 4096;
    std::vector<double> sums((a.size() + piece - 1) / piece);
    in_pieces(a.size(), threads, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i)
            sum += a[i] * b[i];
        sums[begin / piece] = sum;
    });
    double sum = 0;
    for (const double part : sums)
        sum += part;
    return sum;
}

}  // namespace realmodel::interpolation
