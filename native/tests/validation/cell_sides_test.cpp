// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_sides.hpp"

#include <gtest/gtest.h>

#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

std::vector<Side> of(std::span<const Side> sides) {
    return {sides.begin(), sides.end()};
}

TEST(SidesByCell, EachCellHasItsFacesInOrderAndTheSharedOneFromItsOtherSide) {
    auto cubes = two_cubes();
    const ComplexView model = cubes.view();
    const SidesByCell sides(model, {2, nullptr});
    EXPECT_EQ(of(sides[0]), (std::vector<Side>{0, 2, 6, 8, 10, 12}));
    EXPECT_EQ(of(sides[1]), (std::vector<Side>{3, 4, 14, 16, 18, 20}));
    EXPECT_EQ(face_of(sides[1][0]), 1U);
    EXPECT_TRUE(is_reversed(sides[1][0]));
    EXPECT_FALSE(is_reversed(sides[0][1]));
    EXPECT_EQ(sides.values.end(), sides[1].data() + 6);
}

TEST(SidesByCell, ACellWithoutFacesHasNone) {
    auto cubes = two_cubes();
    cubes.block.push_back(0);
    EXPECT_TRUE(SidesByCell(cubes.view(), {1, nullptr})[2].empty());
}

TEST(SidesByCell, ManyFacesInSeveralChunksStayInOrder) {
    auto cubes = two_cubes();
    for (int i = 0; i < 10000; ++i)
        cubes.add_face({0, 1, 2}, i % 2, 1 - i % 2, 0);
    const SidesByCell sides(cubes.view(), {3, nullptr});
    for (const std::size_t cell : {0U, 1U}) {
        EXPECT_EQ(sides[cell].size(), 10006U);
        EXPECT_TRUE(std::ranges::is_sorted(sides[cell]));
    }
}

}  // namespace
}  // namespace realmodel::validation
