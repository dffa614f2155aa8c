// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, APartBetweenTwoPolygonsThatLieOnEachOtherVanishes) {
    cut_at(0.5);
    parts_.push_back({0, kBelow});  // between the lower part and the upper one
    pieces_[kCap].parts = {2, 1};
    const CutPiece under{-1, {0, 0}, {kBelow, kBelow}, false, {0, 2}};
    pieces_.add(std::array{NodeId{8}, NodeId{9}, NodeId{11}, NodeId{10}}, under);
    RoundedParts parts = rounded_parts();
    drop_hollow(parts);
    EXPECT_EQ(pieces_[kCap].parts, (std::array{0, 1}));
    EXPECT_EQ(pieces_[kCap + 1].parts, (std::array{-1, -1}));
    EXPECT_TRUE(parts.pieces_of[2].empty());
}

TEST_F(AHalvedBox, PartsThatHaveOnlyEachOtherAroundThemVanish) {
    cut_at(0.5);
    parts_.insert(parts_.end(), 2, {0, kBelow});
    const CutPiece between{-1, {0, 0}, {kBelow, kBelow}, false, {2, 3}};
    for (const auto& triangle :
         std::array<std::array<NodeId, 3>, 4>{{{8, 9, 10}, {8, 11, 9}, {9, 11, 10}, {8, 10, 11}}})
        pieces_.add(triangle, between);
    RoundedParts parts = rounded_parts();
    drop_hollow(parts);
    EXPECT_TRUE(parts.pieces_of[2].empty());
    EXPECT_TRUE(parts.pieces_of[3].empty());
    EXPECT_EQ(parts.pieces_of[0].size(), 6U);
}

TEST_F(AHalvedBox, PartsWithMorePolygonsStay) {
    cut_at(0.5);
    RoundedParts parts = rounded_parts();
    drop_hollow(parts);
    EXPECT_EQ(parts.pieces_of[0].size(), 6U);
    EXPECT_EQ(parts.pieces_of[1].size(), 6U);
}

}  // namespace
}  // namespace realmodel::cutting
