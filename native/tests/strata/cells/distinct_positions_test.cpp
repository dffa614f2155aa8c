// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/distinct_positions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace realmodel::strata {
namespace {

/// A triangle with a given cell beneath it; each of its points is a plan vertex of its own, with
/// one vertex.
class DistinctPositionsTest : public testing::Test {
protected:
    /// @param inputs  so many of the points are input vertices, which never move
    DistinctPositionsTest() = default;

    /// @param border  of a tile, or nothing
    std::vector<FlatCell> spread(const std::array<PlanPosition, 3>& at, int inputs,
                                 const TileBorder* border = nullptr) {
        for (int i = 0; i < inputs; ++i)
            geometry_.add_vertex(at[static_cast<std::size_t>(i)][0] + 10 * (i + 1), i);
        geometry_.freeze_vertices();
        places_.representative = Array<PointId>(3);
        places_.position = Array<PlanPosition>(3);
        loops_.vertex_offsets = Array<std::int32_t>(4);
        std::array<Corner, 3> corners;
        for (std::int32_t i = 0; i < 3; ++i) {
            const auto p = static_cast<std::size_t>(i);
            corners[p] = {PointId(i), DirectedLine(LineId(0))};
            places_.representative[p] = PointId(i);
            places_.position[p] = at[p];
            loops_.vertex_offsets[p] = i;
            loops_.positions.push_back({at[p][0], at[p][1], 0.0});
        }
        loops_.vertex_offsets[3] = 3;
        loops_.vertices = {0, 1, 2};
        loops_.face_offsets = {0, 3};
        loops_.entries = CornerOffsets({}, 3, {1, nullptr});
        FaceList faces;
        faces.add(corners, PlaneId(0), 0, kOutsideCell, 0);
        return make_distinct(geometry_, faces, places_, loops_, border, {1, nullptr});
    }

    exact::PlanArrangement geometry_;
    PlanVertices places_;
    ConformedFaces loops_;
};

TEST_F(DistinctPositionsTest, WhatHasAnExtentStays) {
    EXPECT_TRUE(spread({{{0, 0}, {0, 1}, {1, 0}}}, 0).empty());
    EXPECT_EQ(loops_.positions[2], (std::array<double, 3>{1, 0, 0}));
}

TEST_F(DistinctPositionsTest, AFlatCellGetsAnExtentByOneUnitInTheLastPlace) {
    EXPECT_TRUE(spread({{{1, 0}, {1, 1}, {1, 2}}}, 2).empty());
    EXPECT_EQ(loops_.positions[0][0], 1.0);
    EXPECT_EQ(loops_.positions[1][0], 1.0);
    EXPECT_NE(loops_.positions[2][0], 1.0);
    EXPECT_NEAR(loops_.positions[2][0], 1.0, 1e-15);
}

TEST_F(DistinctPositionsTest, WhereNothingMayMoveTheCellIsReported) {
    const auto left = spread({{{1, 0}, {1, 1}, {1, 2}}}, 3);
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].cell, 0);
    EXPECT_EQ(left[0].at, (PlanPosition{1, 0}));
    EXPECT_EQ(loops_.positions[2][0], 1.0);
}

TEST_F(DistinctPositionsTest, WhatIsOnTheBorderOfATileStaysThere) {
    const TileBorder border{{0, 0, 4, 4}, {{0, {true, false}}, {1, {true, false}}}, {}};
    spread({{{4, 2}, {4, 2}, {1, 0.5}}}, 0, &border);
    // the second one is coincident
    places_.coincident = {1};
    make_distinct(geometry_, {}, places_, loops_, &border, {1, nullptr});
    EXPECT_EQ(loops_.positions[0], (std::array<double, 3>{4, 2, 0}));
    EXPECT_EQ(loops_.positions[1][0], 4.0);
    EXPECT_NE(loops_.positions[1][1], 2.0);
    EXPECT_NEAR(loops_.positions[1][1], 2.0, 1e-15);
}

TEST_F(DistinctPositionsTest, WhatRoundedToTheBorderOfATileMovesInside) {
    const TileBorder border{{0, 0, 4, 4}, {{1, {false, false}}, {2, {false, true}}}, {}};
    EXPECT_TRUE(spread({{{1, 3}, {4, 2}, {0, 0}}}, 0, &border).empty());
    EXPECT_EQ(loops_.positions[1][0], std::nextafter(4.0, 0.0));
    EXPECT_NEAR(loops_.positions[1][1], 2.0, 1e-15);
    EXPECT_GT(loops_.positions[2][0], 0.0);
    EXPECT_LT(loops_.positions[2][0], 1e-300);
    EXPECT_EQ(loops_.positions[2][1], 0.0);
}

}  // namespace
}  // namespace realmodel::strata
