// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/region_loops.hpp"

#include <gtest/gtest.h>

namespace realmodel::arrangement {
namespace {

using Nodes = std::vector<std::int32_t>;

std::int8_t facing(const Nodes& one, const Nodes& other) {
    return facing_of(std::span(one), std::span(other));
}

TEST(FacingOf, LoopsOfTheSameNodesMayBeginAnywhere) {
    EXPECT_EQ(facing({1, 2, 3, 4}, {3, 4, 1, 2}), 1);
    EXPECT_EQ(facing({1, 2, 3, 4}, {2, 1, 4, 3}), -1);
    EXPECT_EQ(facing({1, 2, 3, 4}, {1, 3, 2, 4}), 0);
    EXPECT_EQ(facing({1, 2, 3}, {1, 2, 3, 4}), 0);
    EXPECT_EQ(facing({1, 2, 3, 2, 5}, {2, 5, 1, 2, 3}), 1);  // a node that is passed twice
    EXPECT_EQ(facing({1, 2, 3, 2, 5}, {2, 3, 2, 1, 5}), -1);
}

TEST(LoopHash, IsTheSameWhereverALoopBegins) {
    const Nodes one{1, 2, 3, 4}, same{3, 4, 1, 2}, other{1, 2, 3, 5};
    EXPECT_EQ(loop_hash(std::span(one)), loop_hash(std::span(same)));
    EXPECT_NE(loop_hash(std::span(one)), loop_hash(std::span(other)));
}

TEST(LoopTable, HasLoopsOfRegions) {
    LoopTable<std::int32_t> table;
    table.add_loop(Nodes{1, 2, 3});
    table.add_loop(Nodes{7, 8});
    table.end_region();
    table.nodes.push_back(4);
    table.end_loop();
    table.end_region();
    ASSERT_EQ(table.size(), 2U);
    ASSERT_EQ(table[0].size(), 2U);
    EXPECT_EQ(table[0][1][1], 8);
    std::size_t nodes = 0;
    for (const auto loop : table[0])
        nodes += loop.size();
    EXPECT_EQ(nodes, 5U);
    EXPECT_EQ(table[1][0][0], 4);
}

}  // namespace
}  // namespace realmodel::arrangement
