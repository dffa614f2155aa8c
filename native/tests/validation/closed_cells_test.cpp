// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/closed_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

using Edge = std::array<std::int64_t, 4>;  // its vertices, how often ahead and back

/// The open edge of a cell, the same whether it is taken for small or for large; none: all 0.
Edge open_edge_of(OwnedComplex& complex, std::size_t cell = 0) {
    const ComplexView model = complex.view();
    const SidesByCell sides(model, {1, nullptr});
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
