// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"
#include "cutting/rounding/rounded_parts.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, TheShapeOfAPartCountsItsPolygons) {
    cut_at(0.5);
    RoundedParts parts = rounded_parts();
    Contraction::ShapeScratch scratch;
    const auto shape = Contraction(parts, false).shape(0, scratch);
    ASSERT_TRUE(shape);
    EXPECT_EQ(shape->count, 6U);
    EXPECT_EQ(shape->touches, 0U);
    EXPECT_EQ(shape->box.high, (Position{1, 1, 0.5}));
}

TEST_F(AHalvedBox, APartIsNoMoreWhereItsNodesBecomeThoseOfOnePolygon) {
    cut_at(0.5);
    RoundedParts parts = rounded_parts();
    Contraction contraction(parts, false);
    for (NodeId node = 0; node < 4; ++node)
        contraction.becomes[index(node + 8)] = node;
    Contraction::ShapeScratch scratch;
    EXPECT_FALSE(contraction.shape(0, scratch));
    EXPECT_TRUE(contraction.shape(1, scratch));
}

TEST_F(AHalvedBox, APartIsSoundWithAnExtentOrWhereItVanishes) {
    cut_at(0.5);
    RoundedParts parts = rounded_parts();
    Contraction contraction(parts, true);
    Contraction::ShapeScratch scratch;
    EXPECT_TRUE(contraction.is_sound(*contraction.shape(0, scratch), 0));
    for (NodeId node = 0; node < 4; ++node)
        contraction.becomes[index(node + 8)] = node;
    const auto vanished = contraction.shape(0, scratch);
    ASSERT_TRUE(vanished);
    EXPECT_EQ(vanished->count, 0U);
    EXPECT_TRUE(contraction.is_sound(*vanished, 0));
    EXPECT_FALSE(Contraction(parts, false).is_sound(*vanished, 0));
    for (Position& p : new_)
        p[2] = 0;
    EXPECT_FALSE(Contraction(parts, true).is_sound(*Contraction(parts, true).shape(0, scratch), 0));
}

TEST_F(AHalvedBox, EqualPolygonsOfAPartThatFaceEachOtherCancelWhereTheyMay) {
    cut_at(0.5);
    const CutPiece in_two{-1, {0, 0}, {kBelow, kBelow}, false, {0, 0}};
    pieces_.add(std::array<NodeId, 3>{8, 0, 9}, in_two);
    RoundedParts parts = rounded_parts();
    pieces_[kCap + 1].parts = {0, -1};
    pieces_.add_reversed(std::array<NodeId, 3>{8, 0, 9}, pieces_[kCap + 1]);
    parts.update();
    Contraction::ShapeScratch scratch;
    EXPECT_FALSE(Contraction(parts, false).shape(0, scratch));
    const auto shape = Contraction(parts, true).shape(0, scratch);
    ASSERT_TRUE(shape);
    EXPECT_EQ(shape->count, 6U);
}

TEST_F(AHalvedBox, EdgesThatAPartUsesMoreThanTwiceAreTouches) {
    cut_at(0.5);
    pieces_.add(std::array<NodeId, 3>{8, 9, 0}, {-1, {0, -1}, {kBelow, kOn}, false, {0, -1}});
    RoundedParts parts = rounded_parts();
    Contraction::ShapeScratch scratch;
    const auto shape = Contraction(parts, false).shape(0, scratch);
    ASSERT_TRUE(shape);
    EXPECT_EQ(shape->touches, 2U);  // 8-9 and 0-8
}

TEST_F(AHalvedBox, AppliedContractionsTakePolygonsAway) {
    cut_at(0.5);
    RoundedParts parts = rounded_parts();
    Contraction contraction(parts, false);
    contraction.becomes[8] = 0;
    contraction.becomes[9] = 1;
    contraction.apply();
    EXPECT_EQ(pieces_.size(), 10U);  // the lower piece of the side of 0 and 1 vanished
    EXPECT_EQ(nodes(kCap - 1), node_loop({0, 1, 11, 10}));
}

}  // namespace
}  // namespace realmodel::cutting
