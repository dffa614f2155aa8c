// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons that rounding has bent or laid on each other. Nodes 0 to 7 are the box's, 8 to 11 those
// of its cut, in the order of x and then y.
#include "halved_box.hpp"

namespace realmodel::cutting {
namespace {

std::size_t shared_faces(const CellComplex& half) {
    return static_cast<std::size_t>(
        std::ranges::count_if(half.face_cells, [](const auto& cells) { return cells[1] >= 0; }));
}

TEST_F(AHalvedBox, ACapThatIsNoLongerConvexIsDividedRoundANodeInItsMiddle) {
    cut_at(0.5);
    new_[3] = {0.25, 0.25, 0.5};  // beyond the diagonal of the others
    const Cut cut = rounded();
    EXPECT_EQ(cut.section.cells.size(), 4U);
    EXPECT_EQ(std::ranges::count(cut.below.vertices, Position{0.3125, 0.3125, 0.5}), 1);
    expect_distinct(cut.below);
}

TEST_F(AHalvedBox, ACapBentByNoMoreThanRoundingStaysWhole) {
    cut_at(0.5);
    new_[3] = {0.5 - 0x1p-53, 0.5, 0.5};
    EXPECT_EQ(rounded().section.cells.size(), 1U);
}

TEST_F(AHalvedBox, PolygonsOfAHalfThatFaceEachOtherBecomeOne) {
    cut_at(0.5);
    parts_[1].side = kBelow;  // both parts in one half, and a cap of each
    for (Piece& piece : pieces_.origins) {
        if (piece.sides[0] == kAbove) piece.sides[0] = kBelow;
    }
    const Piece upper{-1, {-1, 0}, {kOn, kBelow}, false, {-1, 1}};
    pieces_[pieces_.size() - 1] = {-1, {0, -1}, {kBelow, kOn}, false, {0, -1}};
    pieces_.add(std::array{NodeId{8}, NodeId{9}, NodeId{11}, NodeId{10}}, upper);
    const Cut cut = rounded();
    EXPECT_EQ(cut.below.face_cells.size(), 11U);
    EXPECT_EQ(shared_faces(cut.below), 1U);
}

TEST_F(AHalvedBox, OfPolygonsThatFaceTheSameWayOneIsDivided) {
    cut_at(0.5);
    parts_.push_back({0, kBelow});  // the lower part is there twice
    const std::size_t count = pieces_.size();
    for (std::size_t p = 0; p < count; ++p) {
        Piece piece = pieces_[p];
        if (piece.sides[0] != kBelow) continue;
        piece.parts = {2, -1};
        piece.sides[1] = kOn;
        const std::vector<NodeId> nodes(pieces_.polygons[p].begin(), pieces_.polygons[p].end());
        pieces_.add(nodes, piece);
    }
    const Cut cut = rounded();
    EXPECT_EQ(cut.below.cell_block.size(), 2U);
    EXPECT_EQ(cut.below.face_cells.size(), 6U + 6 * 4);
    EXPECT_EQ(cut.below.vertices.size(), 8U + 6);
    expect_distinct(cut.below);
}

TEST_F(AHalvedBox, APartBetweenTwoPolygonsThatLieOnEachOtherVanishes) {
    cut_at(0.5);
    parts_.push_back({0, kBelow});  // between the lower part and the upper one
    pieces_[pieces_.size() - 1].parts = {2, 1};
    const Piece under{-1, {0, 0}, {kBelow, kBelow}, false, {0, 2}};
    pieces_.add(std::array{NodeId{8}, NodeId{9}, NodeId{11}, NodeId{10}}, under);
    const Cut cut = rounded();
    EXPECT_EQ(cut.below.cell_block.size(), 1U);
    EXPECT_EQ(cut.below.face_cells.size(), 6U);
    EXPECT_EQ(cut.section.cells.size(), 1U);
}

}  // namespace
}  // namespace realmodel::cutting
