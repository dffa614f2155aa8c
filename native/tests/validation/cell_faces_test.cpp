// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_faces.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

std::vector<OrientedFace> of(std::span<const OrientedFace> sides) {
    return {sides.begin(), sides.end()};
}

TEST(FacesByCell, EachCellHasItsFacesInOrderAndTheSharedOneFromItsOtherSide) {
    auto cubes = two_cubes();
    const ComplexView model = cubes.view();
    const FacesByCell sides(model, {2, nullptr});
    EXPECT_EQ(of(sides[0]), (std::vector<OrientedFace>{0, 2, 6, 8, 10, 12}));
    EXPECT_EQ(of(sides[1]), (std::vector<OrientedFace>{3, 4, 14, 16, 18, 20}));
    EXPECT_EQ(face_of(sides[1][0]), 1U);
    EXPECT_TRUE(is_reversed(sides[1][0]));
    EXPECT_FALSE(is_reversed(sides[0][1]));
    EXPECT_EQ(sides.values.end(), sides[1].data() + 6);
}

TEST(FacesByCell, ACellWithoutFacesHasNone) {
    auto cubes = two_cubes();
    cubes.block.push_back(0);
    EXPECT_TRUE(FacesByCell(cubes.view(), {1, nullptr})[2].empty());
}

TEST(FacesByCell, ManyFacesInSeveralChunksStayInOrder) {
    auto cubes = two_cubes();
    for (int i = 0; i < 10000; ++i)
        cubes.add_face({0, 1, 2}, i % 2, 1 - i % 2, 0);
    const FacesByCell sides(cubes.view(), {3, nullptr});
    for (const std::size_t cell : {0U, 1U}) {
        EXPECT_EQ(sides[cell].size(), 10006U);
        EXPECT_TRUE(std::ranges::is_sorted(sides[cell]));
    }
}

using Edge = std::array<std::int64_t, 4>;  // its vertices, how often ahead and back

/// The open edge of a cell, the same whether it is taken for small or for large; none: all 0.
Edge open_edge_of(OwnedComplex& complex, std::size_t cell = 0) {
    const ComplexView model = complex.view();
    const FacesByCell sides(model, {1, nullptr});
    EdgeTable table;
    const auto numbers = [](const std::optional<EdgeCount>& use) {
        return use ? Edge{use->low, use->high, use->ahead, use->back} : Edge{};
    };
    const Edge small = numbers(open_edge(model, sides[cell], table));
    EXPECT_EQ(numbers(open_edge_of_large_cell(model, sides[cell], {2, nullptr})), small);
    return small;
}

TEST(ClosedCells, ACubeIsClosedAndSoIsTheOneThatSharesAFace) {
    auto cubes = two_cubes();
    EXPECT_EQ(open_edge_of(cubes, 0), Edge{});
    EXPECT_EQ(open_edge_of(cubes, 1), Edge{});
}

TEST(ClosedCells, OfAHoleTheLeastEdgeIsNamed) {
    auto cubes = two_cubes();
    cubes.cells[3] = {1, -1};                            // the wall 0-1-5-4
    EXPECT_EQ(open_edge_of(cubes), (Edge{0, 1, 0, 1}));  // the base runs from 1 to 0
}

TEST(ClosedCells, AFaceTurnedOverUsesItsEdgesTwiceOneWay) {
    auto cubes = two_cubes();
    std::ranges::reverse(cubes.loops[2]);  // the top
    EXPECT_EQ(open_edge_of(cubes, 0), Edge{});
    EXPECT_EQ(open_edge_of(cubes, 1), (Edge{8, 9, 0, 2}));
}

TEST(ClosedCells, OnlyInBlocksAnEdgeMayBeUsedTwiceEachWay) {
    auto cubes = two_cubes();
    for (std::size_t f = 0; f < 11; ++f)  // both cubes as one cell, their common face twice
        cubes.cells[f] = {0, -1};
    cubes.add_face({7, 6, 5, 4}, 0, -1, 0);
    EXPECT_EQ(open_edge_of(cubes), (Edge{4, 5, 2, 2}));
    cubes.blocks = true;
    EXPECT_EQ(open_edge_of(cubes), Edge{});
    std::ranges::reverse(cubes.loops[11]);
    EXPECT_EQ(open_edge_of(cubes), (Edge{4, 5, 3, 1}));
}

}  // namespace
}  // namespace realmodel::validation
