// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <set>

#include "../validation/small_complex.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {
namespace {

using PlanPosition = std::array<double, 2>;

/// Through two unit cubes, one on the other.
Section panel(const PlanPosition& start, const PlanPosition& end) {
    auto cubes = validation::two_cubes();
    return fence_panel(cubes.view(), start, end, {1, nullptr});
}

Position normal(const Section& section, std::size_t polygon) {
    std::vector<Position> corners;
    for (std::int64_t i = section.offsets[polygon]; i < section.offsets[polygon + 1]; ++i)
        corners.push_back(section.vertices[index(section.polygon_vertices[index(i)])]);
    return polygon_normal(corners);
}

TEST(FencePanel, IsCutOffAtBothEnds) {
    const Section section = panel({0.25, 0.5}, {0.75, 0.5});
    EXPECT_EQ(section.cells, (std::vector<std::array<std::int32_t, 2>>{{0, 0}, {1, 1}}));
    const std::set<Position> found(section.vertices.begin(), section.vertices.end());
    EXPECT_EQ(found, (std::set<Position>{{0.25, 0.5, 0},
                                         {0.75, 0.5, 0},
                                         {0.25, 0.5, 1},
                                         {0.75, 0.5, 1},
                                         {0.25, 0.5, 2},
                                         {0.75, 0.5, 2}}));
    EXPECT_EQ(section.vertices.size(), found.size()) << "neighbors share their corners";
}

TEST(FencePanel, TurnsCounterClockwiseWhereDistanceRunsToTheRight) {
    EXPECT_EQ(normal(panel({0.25, 0.5}, {0.75, 0.5}), 0), (Position{0, -1, 0}));
    EXPECT_EQ(normal(panel({0.75, 0.5}, {0.25, 0.5}), 0), (Position{0, 1, 0}));
}

TEST(FencePanel, BeyondTheModelItStaysAsLongAsTheModel) {
    EXPECT_EQ(normal(panel({-3, 0.5}, {5, 0.5}), 1), (Position{0, -2, 0}));
}

TEST(FencePanel, ThatOnlyTouchesTheModelIsEmpty) {
    for (const Section& section : {panel({1, 0.5}, {2, 0.5}), panel({-1, 0.5}, {0, 0.5})}) {
        EXPECT_TRUE(section.cells.empty());
        EXPECT_TRUE(section.vertices.empty());
        EXPECT_EQ(section.offsets, std::vector<std::int64_t>{0});
    }
}

TEST(FencePanel, NeedsTwoEnds) {
    EXPECT_THROW(panel({0.5, 0.5}, {0.5, 0.5}), InputError);
}

}  // namespace
}  // namespace realmodel::cutting
