// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"
#include "base/floating_point.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, NodesWhereOthersAreMoveBesideThem) {
    cut_at(1);
    new_[1] = new_[0] = {0.25, 0.25, 1};
    pieces_.polygons.clear();
    pieces_.origins.clear();
    pieces_.add(std::array<NodeId, 4>{8, 9, 11, 10}, {-1, {0, 0}, {kBelow, kAbove}, true, {0, 1}});
    RoundedParts parts = rounded_parts();
    separate_coincident_nodes(parts);
    EXPECT_EQ(new_[0], (Position{0.25, 0.25, 1}));
    EXPECT_NE(new_[1], new_[0]);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LE(std::abs(new_[1][k] - new_[0][k]), ulp(new_[0][k]));
}

TEST_F(AHalvedBox, NodesOfWallsMoveUpOrDown) {
    cut_at(2);  // each new node is where a corner of the top is
    RoundedParts parts = rounded_parts();
    separate_coincident_nodes(parts);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(new_[i][0], i & 1 ? 1.0 : 0.0);
        EXPECT_EQ(new_[i][1], i & 2 ? 1.0 : 0.0);
        EXPECT_NE(new_[i][2], 2.0);
    }
}

TEST_F(AHalvedBox, NodesThatNoPolygonHasStay) {
    cut_at(0.5);
    new_.push_back({0, 0, 0});
    RoundedParts parts = rounded_parts();
    separate_coincident_nodes(parts);
    EXPECT_EQ(new_.back(), (Position{0, 0, 0}));
}

}  // namespace
}  // namespace realmodel::cutting
