// SPDX-License-Identifier: GPL-3.0-or-later
#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, PolygonsOfAHalfThatFaceEachOtherBecomeOne) {
    cut_at(0.5);
    parts_[1].side = kBelow;  // both parts in one half, and a cut face of each
    for (CutPiece& piece : pieces_.origins) {
        if (piece.sides[0] == kAbove) piece.sides[0] = kBelow;
    }
    pieces_[kCap] = {-1, {0, -1}, {kBelow, kOn}, false, {0, -1}};
    pieces_.add(std::array<NodeId, 4>{8, 9, 11, 10}, {-1, {-1, 0}, {kOn, kBelow}, false, {-1, 1}});
    RoundedParts parts = rounded_parts();
    const auto doubled = merge_coincident_faces(parts);
    ASSERT_EQ(pieces_.size(), 11U);
    EXPECT_EQ(pieces_[0].parts, (std::array{0, 1}));  // glued ones come first
    EXPECT_EQ(nodes(0), node_loop({8, 9, 11, 10}));
    EXPECT_EQ(std::ranges::count(doubled, 0), 11);
}

TEST_F(AHalvedBox, PolygonsOfAWholeCellThatFaceEachOtherVanish) {
    parts_ = {{0, kBelow}};
    for (std::size_t f = 0; f < kFaces.size(); ++f)
        add(static_cast<std::int32_t>(f), kBelow, {kFaces[f].begin(), kFaces[f].end()});
    add(5, kBelow, {0, 4, 6});  // the cutter has divided that wall where it has no extent
    add(5, kBelow, {0, 6, 4});
    RoundedParts parts = rounded_parts();
    merge_coincident_faces(parts);
    EXPECT_EQ(pieces_.size(), 6U);
}

TEST_F(AHalvedBox, OfPolygonsThatFaceTheSameWayAllButOneAreDoubled) {
    cut_at(0.5);
    pieces_.add(pieces_.polygons[2], {2, {0, -1}, {kBelow, kOn}, false, {0, -1}});
    RoundedParts parts = rounded_parts();
    const auto doubled = merge_coincident_faces(parts);
    ASSERT_EQ(doubled.size(), 12U);
    EXPECT_EQ(std::ranges::count(doubled, 1), 1);
    EXPECT_EQ(doubled[11], 1);
}

}  // namespace
}  // namespace realmodel::cutting
