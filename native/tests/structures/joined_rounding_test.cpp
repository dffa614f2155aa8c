// SPDX-License-Identifier: GPL-3.0-or-later
// The passes that joining has, on the halves of a box.
#include "structures/joined_rounding.hpp"

#include "../cutting/halved_box.hpp"
#include "base/floating_point.hpp"

namespace realmodel::structures {
namespace {

using cutting::kBelow;
using cutting::NodeId;
using cutting::Position;
using cutting::RoundedParts;
using realmodel::node_loop;

class JoinedHalves : public cutting::AHalvedBox {
protected:
    JoinedHalves() { cut_at(0.5); }
    void add_piece(const std::vector<NodeId>& polygon, const std::array<std::int32_t, 2>& parts) {
        pieces_.add(
            polygon,
            {-1, {parts[0] < 0 ? -1 : 0, parts[1] < 0 ? -1 : 0}, {kBelow, kBelow}, false, parts});
    }
};

TEST_F(JoinedHalves, PolygonsThatFaceEachOtherWithinAPartCancel) {
    // the cap between 0 and 1 and one more on it, of part 0 alone, that faces the other way
    add_piece({10, 11, 9, 8}, {0, -1});
    RoundedParts parts = rounded_parts(true);
    cancel_facing(parts);
    ASSERT_EQ(pieces_.size(), 11U);
    EXPECT_EQ(pieces_[0].parts, (std::array{-1, 1}));  // what is left comes first
    EXPECT_EQ(nodes(0), node_loop({8, 9, 11, 10}));
}

TEST_F(JoinedHalves, ANeedleBecomesOneWithThePartBesideIt) {
    for (std::size_t y = 1; y < vertices_.size(); y += 3)
        vertices_[y] *= 0x1p-50;
    for (Position& p : new_)
        p = {p[0], p[1] * 0x1p-50, 0x1p-50};
    RoundedParts parts = rounded_parts(true);
    merge_needles(parts, 0);
    EXPECT_TRUE(parts.pieces_of[0].empty());
    EXPECT_EQ(parts.pieces_of[1].size(), 10U);
    EXPECT_EQ(pieces_[kCap].parts, (std::array{-1, -1}));
}

TEST_F(JoinedHalves, PolygonsOfTwoPartsStay) {
    add_piece({8, 9, 11, 10}, {0, -1});
    RoundedParts parts = rounded_parts(true);
    cancel_facing(parts);
    EXPECT_EQ(pieces_.size(), 12U);
}

TEST_F(JoinedHalves, AnEdgeAsShortAsRoundingIsContracted) {
    new_[1] = {0, 0, 0.5 + ulp(0.5)};  // beside node 8
    RoundedParts parts = rounded_parts(true);
    join_short_edges(parts, 0);
    EXPECT_EQ(nodes(kCap), node_loop({8, 11, 10}));
}

TEST_F(JoinedHalves, ALongerEdgeIsContractedOnlyWhereRoundingIsCoarser) {
    new_[1] = {0x1p-30, 0, 0.5};
    {
        RoundedParts parts = rounded_parts(true);
        join_short_edges(parts, 0);
        EXPECT_EQ(nodes(kCap), node_loop({8, 9, 11, 10}));
    }
    surfaces_.assign(6, 1);  // walls would keep their nodes
    RoundedParts parts = rounded_parts(true);
    join_short_edges(parts, 0x1p-29);
    EXPECT_EQ(nodes(kCap), node_loop({8, 11, 10}));
}

TEST_F(JoinedHalves, APartThatRoundingAloneKeepsOpenIsNoMore) {
    for (Position& p : new_)
        p[2] = ulp(0.5);
    RoundedParts parts = rounded_parts(true);
    join_short_edges(parts, 0);
    cancel_facing(parts);
    EXPECT_TRUE(parts.pieces_of[0].empty());
    ASSERT_EQ(parts.pieces_of[1].size(), 6U);
    // what it stands on was below the other part
    EXPECT_EQ(pieces_[0].parts, (std::array{-1, 1}));
    EXPECT_EQ(pieces_[0].face, 0);
}

TEST_F(JoinedHalves, ANodeMovesAlongAWallButNotOffIt) {
    surfaces_[3] = 1;  // node 9 is on the wall of y = 0 alone
    new_[1] = {0x1p-30, 0x1p-30, 0.5};
    {
        RoundedParts parts = rounded_parts(true);
        join_short_edges(parts, 0x1p-29);
        EXPECT_EQ(nodes(kCap), node_loop({8, 9, 11, 10}));
    }
    new_[1][1] = 0;
    RoundedParts parts = rounded_parts(true);
    join_short_edges(parts, 0x1p-29);
    EXPECT_EQ(nodes(kCap), node_loop({8, 11, 10}));
}

TEST_F(JoinedHalves, WhereAPartTouchesItselfTheWayRoundGetsANodeOfItsOwn) {
    // part 2 lies along the edge of 8 and 9, and part 0 comes back to that edge beyond it
    new_.insert(new_.end(), {{0.5, -1, 0}, {0.5, -1, 1}});
    parts_.push_back({0, kBelow});
    add_piece({8, 9, 12}, {0, 2});
    add_piece({8, 9, 13}, {2, 0});
    RoundedParts parts = rounded_parts(true);
    set_touching_apart(parts);
    ASSERT_EQ(new_.size(), 7U);
    EXPECT_EQ(new_[6], (Position{0.5, 0, 0.5}));
    EXPECT_EQ(nodes(11), node_loop({8, 14, 9, 12}));
    EXPECT_EQ(nodes(12), node_loop({8, 14, 9, 13}));
    EXPECT_EQ(nodes(kCap), node_loop({8, 9, 11, 10}));
}

TEST_F(JoinedHalves, RoundedTogetherTheyAreSound) {
    add_piece({10, 11, 9, 8}, {0, -1});
    add_piece({8, 9, 11, 10}, {0, -1});
    round_joined_parts(rounded_parts(true), {false, false}, 0);
    EXPECT_EQ(parts_.size(), 2U);
    EXPECT_EQ(pieces_.size(), 11U);
}

}  // namespace
}  // namespace realmodel::structures
