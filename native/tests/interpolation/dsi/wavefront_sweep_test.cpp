// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/wavefront_sweep.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <random>

namespace realmodel::interpolation {
namespace {

TEST(WavefrontSweep, EachPieceFindsWhatItReachesDoneAtTheStageBefore) {
    std::mt19937 random(5);
    for (const std::ptrdiff_t pieces : {1, 7, 40, 200}) {
        for (const int spread : {0, 3, 1000}) {
            std::vector<WavefrontSweep::Reach> reach;
            for (std::ptrdiff_t p = 0; p < pieces; ++p) {
                const auto away = [&] {
                    return static_cast<std::ptrdiff_t>(random()) % (spread + 1);
                };
                reach.emplace_back(std::max<std::ptrdiff_t>(0, p - away()),
                                   std::min(pieces - 1, p + away()));
            }
            const WavefrontSweep sweep(reach);
            for (const int threads : {1, 2, 5}) {
                std::vector<std::atomic<int>> done(static_cast<std::size_t>(pieces));
                std::atomic<int> too_early{0};
                const double sum =
                    sweep.sum(4, threads, [&](std::size_t stage, std::ptrdiff_t piece) {
                        const auto [first, last] = reach[static_cast<std::size_t>(piece)];
                        for (std::ptrdiff_t p = first; p <= last; ++p) {
                            if (done[static_cast<std::size_t>(p)] < static_cast<int>(stage))
                                ++too_early;
                        }
                        if (done[static_cast<std::size_t>(piece)]++ != static_cast<int>(stage))
                            ++too_early;
                        return static_cast<double>(piece);
                    });
                EXPECT_EQ(too_early, 0) << pieces << " pieces, " << spread << ", " << threads;
                EXPECT_EQ(sum, static_cast<double>(pieces * (pieces - 1) / 2));
                for (const auto& stages : done)
                    EXPECT_EQ(stages, 4);
            }
        }
    }
}

TEST(WavefrontSweep, WhatAPieceThrowsReachesTheCaller) {
    std::vector<WavefrontSweep::Reach> reach;
    for (std::ptrdiff_t p = 0; p < 100; ++p)
        reach.emplace_back(std::max<std::ptrdiff_t>(0, p - 2), std::min<std::ptrdiff_t>(99, p + 2));
    const WavefrontSweep sweep(reach);
    for (const int threads : {1, 2, 5}) {
        for (const std::size_t failing : {0U, 2U}) {
            EXPECT_THROW(sweep.run(3, threads,
                                   [&](std::size_t stage, std::ptrdiff_t piece) {
                                       if (stage == failing && piece == 50) throw std::bad_alloc();
                                   }),
                         std::bad_alloc);
        }
    }
}

}  // namespace
}  // namespace realmodel::interpolation
