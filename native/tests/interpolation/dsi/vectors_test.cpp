// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <new>

#include "interpolation/dsi/wavefront_sweep.hpp"

namespace realmodel::interpolation {
namespace {

TEST(Vectors, PiecesAndRowsCoverEverythingOnce) {
    for (const std::size_t count : {0UL, 1UL, 4096UL, 4097UL, 100000UL}) {
        std::vector<int> seen(count, 0), rows(count, 0);
        in_pieces(count, 3, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                ++seen[i];
        });
        for_rows(count, 3, [&](std::size_t row) { ++rows[row]; });
        EXPECT_EQ(seen, std::vector<int>(count, 1));
        EXPECT_EQ(rows, seen);
    }
}

TEST(Vectors, ADotProductHasTheSameBytesForAnyNumberOfThreads) {
    Vector a(200000), b(200000);
    for (std::size_t i = 0; i < a.size(); ++i) {
        a[i] = std::sin(static_cast<double>(i));
        b[i] = 1 / (1 + static_cast<double>(i));
    }
    EXPECT_EQ(dot(a, b, 1), dot(a, b, 4));
    EXPECT_EQ(dot(Vector{1, 2}, Vector{3, 4}, 1), 11);
}

TEST(Vectors, WantOfMemoryInAPieceReachesTheCaller) {
    for (const int threads : {1, 3}) {
        EXPECT_THROW(in_pieces(1 << 20, threads,
                               [](std::size_t begin, std::size_t) {
                                   if (begin > 500000) throw std::bad_alloc();
                               }),
                     std::bad_alloc);
        EXPECT_THROW(for_rows(1000, threads,
                              [](std::size_t row) {
                                  if (row == 999) throw std::bad_alloc();
                              }),
                     std::bad_alloc);
    }
}

}  // namespace
}  // namespace realmodel::interpolation
