// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, ANodeWhereAVertexIsBecomesIt) {
    cut_at(0.5);
    for (Position& p : new_)
        p[2] = p[0] / 2 + p[1] / 4;  // node 8 is at vertex 0
    RoundedParts parts = rounded_parts();
    join_coincident(parts, {false, false}, false);
    ASSERT_EQ(pieces_.size(), 11U);
    EXPECT_EQ(nodes(kCap), node_loop({0, 9, 11, 10}));
    EXPECT_EQ(nodes(2), node_loop({0, 1, 9}));
}

TEST_F(AHalvedBox, NodesInOnePositionBecomeTheFirst) {
    cut_at(0.5);
    new_[1] = new_[0];
    RoundedParts parts = rounded_parts();
    join_coincident(parts, {false, false}, false);
    EXPECT_EQ(nodes(kCap), node_loop({8, 11, 10}));
}

TEST_F(AHalvedBox, NodesStayApartWhereAPartWouldVanish) {
    cut_at(0);
    RoundedParts parts = rounded_parts();
    join_coincident(parts, {false, false}, false);
    EXPECT_EQ(nodes(kCap), node_loop({8, 9, 11, 10}));
    EXPECT_EQ(nodes(2), node_loop({0, 1, 9, 8}));
}

}  // namespace
}  // namespace realmodel::cutting
