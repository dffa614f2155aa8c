// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/hash_grid.hpp"

#include <gtest/gtest.h>

#include <random>

namespace realmodel::spatial {
namespace {

TEST(HashGrid, AsksOfAllWithinReachOnce) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> place(-12,
                                             12);  // many at equal places and on sides of cells
    for (const double side : {0.5, 2.0, 100.0}) {
        HashGrid<3> grid(side);
        std::vector<HashGrid<3>::GridPosition> points;
        for (int i = 0; i < 300; ++i) {
            points.push_back({0.5 * place(random), 0.5 * place(random), 0.5 * place(random)});
            grid.add(points.back());
        }
        EXPECT_EQ(grid.points(), points);
        for (const auto& around : {points[0], points[7], {9, 9, 9}}) {
            std::vector<int> asked(points.size(), 0);
            EXPECT_FALSE(grid.any(around, 1, [&](std::size_t i) { return ++asked[i] < 0; }));
            for (std::size_t i = 0; i < points.size(); ++i) {
                bool is_near = true;
                for (std::size_t k = 0; k < 3; ++k)
                    is_near = is_near && std::abs(points[i][k] - around[k]) <= 1;
                EXPECT_LE(asked[i], 1);
                EXPECT_GE(asked[i], is_near ? 1 : 0);
            }
        }
    }
}

TEST(HashGrid, StopsAtTheFirstThatHolds) {
    HashGrid<2> grid(1);
    EXPECT_FALSE(grid.any({0, 0}, 1, [](std::size_t) { return true; }));
    for (int i = 0; i < 5; ++i)
        grid.add({0.1 * i, 0});
    int asked = 0;
    EXPECT_TRUE(grid.any({0, 0}, 1, [&](std::size_t) { return ++asked == 2; }));
    EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace realmodel::spatial
