// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "strata/cells/block_cells.hpp"

namespace realmodel::strata {
namespace {

TEST(NodeCells, AreTheUnionsOfLinkedNodesInOrderOfTheFirst) {
    Construction made;
    for (const std::int32_t block : {2, 1, 2, 1, 2})
        made.add_node(block, true);
    made.links = {{4, 0}, {3, 1}};
    Array<std::int32_t> cell_block;
    const auto cells = cells_of_nodes(made, {}, WholeTriangles(0), cell_block, {2, nullptr});
    EXPECT_EQ(cells, (std::vector<std::int32_t>{0, 1, 2, 1, 0}));
    EXPECT_EQ(cell_block, (Array<std::int32_t>{2, 1, 2}));
}

TEST(NodeCells, AreJoinedAcrossEdgesOfWholeTriangles) {
    // two neighbors between nodes 0, 1 above and 2, 3 below; a third one beside them is not whole
    Construction made;
    for (const std::int32_t block : {1, 1, 0, 0})
        made.add_node(block, true);
    TriangleLinks links;
    links.neighbor = {
        {PlaneId(1), kNone, kNone}, {PlaneId(0), PlaneId(2), kNone}, {PlaneId(1), kNone, kNone}};
    WholeTriangles wholes(3);
    wholes.face[0] = {0, 2, 1};
    wholes.face[1] = {1, 3, 1};
    Array<std::int32_t> cell_block;
    const auto cells = cells_of_nodes(made, links, wholes, cell_block, {1, nullptr});
    EXPECT_EQ(cells, (std::vector<std::int32_t>{0, 0, 1, 1}));
    EXPECT_EQ(cell_block, (Array<std::int32_t>{1, 0}));
}

}  // namespace
}  // namespace realmodel::strata
