// SPDX-License-Identifier: GPL-3.0-or-later
// Two halves of a box, put together by hand.
#include "../halved_box.hpp"

namespace realmodel::cutting {
namespace {

TEST_F(AHalvedBox, StaysAsItIsWhereNothingCoincides) {
    cut_at(0.5);
    const Cut cut = rounded();
    EXPECT_EQ(cut.below.vertices.size(), 8U);
    EXPECT_EQ(cut.above.vertices.size(), 8U);
    EXPECT_DOUBLE_EQ(cut.below.volumes[0], 0.5);
    EXPECT_DOUBLE_EQ(cut.above.volumes[0], 1.5);
    EXPECT_EQ(cut.section.cells, (std::vector<std::array<std::int32_t, 2>>{{0, 0}}));
    EXPECT_EQ(cut.below_cells, std::vector<std::int32_t>{0});
    // what the cut laid open belongs to no surface
    EXPECT_EQ(std::count(cut.below.face_surface.begin(), cut.below.face_surface.end(), kCutFace),
              1);
}

TEST_F(AHalvedBox, APartWithoutThicknessIsGivenOne) {
    cut_at(0);  // every new node is where a vertex is: the lower part would vanish
    const Cut cut = rounded();
    ASSERT_EQ(cut.below.cell_block.size(), 1U);
    expect_distinct(cut.below);
    expect_distinct(cut.above);
    EXPECT_NEAR(cut.below.volumes[0], 0, 1e-300);
    EXPECT_DOUBLE_EQ(cut.above.volumes[0], 2);
}

TEST_F(AHalvedBox, NodesThatCoincideBecomeOneWhereThePartsStaySound) {
    cut_at(0.5);
    for (Position& p : new_)  // one corner of the cut comes to lie on the box's own
        p[2] = p[0] / 2 + p[1] / 4;
    const Cut cut = rounded();
    EXPECT_EQ(cut.below.vertices.size(), 7U);
    EXPECT_EQ(cut.above.vertices.size(), 8U);
    expect_distinct(cut.below);
    EXPECT_DOUBLE_EQ(cut.below.volumes[0], 0.375);
    EXPECT_DOUBLE_EQ(cut.above.volumes[0], 1.625);
}

}  // namespace
}  // namespace realmodel::cutting
