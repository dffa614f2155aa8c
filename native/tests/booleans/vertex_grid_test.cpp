// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/vertex_grid.hpp"

#include <gtest/gtest.h>

namespace realmodel::booleans {
namespace {

TEST(VertexGrid, FindsTheNearestAcrossCellsAndTheFirstOfEquals) {
    SpacePoints points;
    VertexGrid grid(points, 1);  // cells of 2
    const auto add = [&](double x, double y, double z) {
        const SpacePointId p = points.add(exact::SpacePosition{x, y, z});
        grid.add(p);
        grid.add(p);  // once is enough
        return p;
    };
    const SpacePointId left = add(1.5, 0, 0), right = add(2.5, 0, 0);
    add(9, 9, 9);
    EXPECT_EQ(grid.nearest({1.75, 0, 0}, 1), left);
    EXPECT_EQ(grid.nearest({2.25, 0, 0}, 1), right);
    EXPECT_EQ(grid.nearest({2, 0, 0}, 1), left);
    EXPECT_EQ(grid.nearest({2.25, 0, 0}, 0.125), kNone);
    EXPECT_EQ(grid.nearest({2.25, -0.5, 0.5}, 1), right);
    EXPECT_EQ(grid.nearest({-1, 0, 0}, 1), kNone);
}

TEST(KeyNumbers, NumbersKeysInTheOrderInWhichTheyCome) {
    KeyNumbers<std::array<std::int64_t, 3>> table;
    EXPECT_EQ(table.find({1, 2, 3}), -1);
    EXPECT_EQ(table.add({1, 2, 3}), 0);
    EXPECT_EQ(table.add({3, 2, 1}), 1);
    EXPECT_EQ(table.add({1, 2, 3}), 0);
    EXPECT_EQ(table.find({3, 2, 1}), 1);
    EXPECT_EQ(table.size(), 2U);
    EXPECT_EQ(table[1], (std::array<std::int64_t, 3>{3, 2, 1}));
}

}  // namespace
}  // namespace realmodel::booleans
