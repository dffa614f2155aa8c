// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"
#include "cutting/rounding/rounded_parts.hpp"

namespace realmodel::cutting {
namespace {

TEST(WindingOf, SaysWhichWayALoopGoesFromItsLeastNode) {
    EXPECT_EQ(winding_of(node_loop({3, 5, 7})), 1);
    EXPECT_EQ(winding_of(node_loop({7, 3, 5})), 1);
    EXPECT_EQ(winding_of(node_loop({7, 5, 3})), -1);
}

TEST(PutFirst, IsTheSameForLoopsOfTheSameEdges) {
    std::vector<NodeId> one, other, third;
    put_first(node_loop({3, 5, 9, 7}), one);
    put_first(std::array<NodeId, 4>{9, 5, 3, 7}, other);
    put_first(node_loop({3, 9, 5, 7}), third);
    EXPECT_EQ(one, (std::vector<NodeId>{3, 5, 9, 7}));
    EXPECT_EQ(other, one);
    EXPECT_NE(third, one);
}

TEST_F(AHalvedBox, EqualPiecesAreFoundWhicheverWayTheyTurn) {
    cut_at(0.5);
    const CutPiece origin{-1, {0, -1}, {kBelow, kOn}, false, {0, -1}};
    pieces_.add_reversed(pieces_.polygons[kCap], origin);
    pieces_.add(std::array<NodeId, 4>{8, 11, 9, 10}, origin);  // the same nodes, but other edges
    pieces_.add(std::array<NodeId, 4>{11, 10, 8, 9}, origin);
    const auto groups = equal_pieces(rounded_parts());
    ASSERT_EQ(groups.size(), 1U);
    EXPECT_EQ(groups[0], (std::vector<std::size_t>{kCap, kCap + 1, kCap + 3}));
}

}  // namespace
}  // namespace realmodel::cutting
