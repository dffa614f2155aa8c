// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

class TriangulateNonplanar : public AHalvedBox {
protected:
    TriangulateNonplanar() { cut_at(0.5); }
    std::size_t pieces_after(std::vector<std::size_t> doubled = {},
                             bool (*is_bent_too)(std::span<const Position>) = nullptr) {
        RoundedParts parts = rounded_parts();
        std::vector<std::uint8_t> is_doubled(pieces_.size(), 0);
        for (const std::size_t p : doubled)
            is_doubled[p] = 1;
        triangulate_nonplanar(parts, is_doubled, is_bent_too);
        return pieces_.size();
    }
};

TEST_F(TriangulateNonplanar, ACapThatIsNoLongerConvexIsDividedRoundANodeInItsMiddle) {
    new_[3] = {0.375, 0.375, 0.5};  // beyond the diagonal of the others
    EXPECT_EQ(pieces_after(), 14U);
    EXPECT_EQ(nodes(kCap), node_loop({8, 9, 12}));
    EXPECT_EQ(new_.at(4), (Position{0.34375, 0.34375, 0.5}));
}

TEST_F(TriangulateNonplanar, ACapWhoseMiddleDoesNotSeeAllOfItIsDividedInConvexPartsFirst) {
    new_[3] = {0.25, 0.25, 0.5};  // the middle of all, at 0.3125, lies outside
    EXPECT_EQ(pieces_after(), 18U);
    EXPECT_EQ(new_.at(4), (Position{0.125, 0.125, 0.5})) << "of the edge between both parts";
    const RoundedParts parts = rounded_parts();
    double twice = 0;
    for (std::size_t p = kCap; p < kCap + 8; ++p) {
        const auto corners = parts.pieces.polygons[p];
        const Position a = parts.at(corners[0]), b = parts.at(corners[1]), c = parts.at(corners[2]);
        twice += std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    EXPECT_DOUBLE_EQ(twice, 0.5) << "they do not overlap";
}

TEST_F(TriangulateNonplanar, ACapBentByNoMoreThanRoundingStaysWhole) {
    new_[3] = {0.5 - 0x1p-53, 0.5, 0.5};
    EXPECT_EQ(pieces_after(), 11U);
}

TEST_F(TriangulateNonplanar, DoubledPolygonsAreDivided) {
    EXPECT_EQ(pieces_after({0, kCap}), 17U);
    EXPECT_EQ(new_.size(), 6U);
}

TEST_F(TriangulateNonplanar, TheMiddleOfAPolygonIsWhereNoOtherNodeIs) {
    RoundedParts parts = rounded_parts();
    parts.taken.insert({0.5, 0.5, 0.5});
    std::vector<std::uint8_t> is_doubled(pieces_.size(), 0);
    is_doubled[kCap] = 1;
    triangulate_nonplanar(parts, is_doubled);
    ASSERT_EQ(new_.size(), 5U);
    EXPECT_NE(new_[4], (Position{0.5, 0.5, 0.5}));
}

TEST_F(TriangulateNonplanar, WhatIsAskedForToo) {
    EXPECT_EQ(pieces_after({}, [](auto corners) { return corners[0][2] == 0.5; }), 14U);
}

TEST_F(TriangulateNonplanar, AWallWithoutExtentInPlanIsDividedInThoseThatHaveOne) {
    new_[1] = {0, 0, 0.25};
    add(2, kBelow, {8, 9, 0});
    const std::size_t wall = pieces_.size() - 1;
    EXPECT_EQ(pieces_after(), wall + 3);
    const RoundedParts parts = rounded_parts();
    for (std::size_t p = wall; p < pieces_.size(); ++p)
        EXPECT_FALSE(parts.is_upright(p));
}

}  // namespace
}  // namespace realmodel::cutting
