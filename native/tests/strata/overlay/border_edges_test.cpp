// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/border_edges.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {
namespace {

using exact::VertexId;

/// A triangle, and edges between places around it.
class BorderEdgesTest : public testing::Test {
protected:
    VertexId vertex(double x, double y) { return geometry_.add_vertex(x, y); }

    /// Whether an edge divides the triangle (0, 0), (4, 0), (0, 4).
    bool divides(const std::array<double, 2>& from, const std::array<double, 2>& to) {
        const PlanTriangle triangle{vertex(0, 0), vertex(4, 0), vertex(0, 4)};
        const BorderEdges::VertexPair edge{vertex(from[0], from[1]), vertex(to[0], to[1])};
        geometry_.freeze_vertices();
        const auto outline = triangle_outline(geometry_, triangle);
        const PlanTiles tiles({-8, -8, 8, 8}, 64);
        // given twice, either way around
        const BorderEdges borders(geometry_, tiles, {edge, {edge.second, edge.first}});
        LocalArrangement scope(geometry_);
        const TileSpan span = tiles.span({0, 0, 4, 4});
        const bool found = borders.divide(scope, outline, span);
        EXPECT_EQ(borders.divide(geometry_, triangle, span), found);
        return found;
    }

private:
    exact::PlanArrangement geometry_;
};

TEST_F(BorderEdgesTest, AnEdgeAcrossDivides) {
    EXPECT_TRUE(divides({-1, 1}, {5, 1}));
}
TEST_F(BorderEdgesTest, AnEdgeThatEndsInsideDivides) {
    EXPECT_TRUE(divides({1, 1}, {7, 7}));
}
TEST_F(BorderEdgesTest, AnEdgeInsideDivides) {
    EXPECT_TRUE(divides({1, 1}, {1, 1.5}));
}
TEST_F(BorderEdgesTest, AnEdgeThroughACornerDivides) {
    EXPECT_TRUE(divides({0, 0}, {2, 2}));
}
TEST_F(BorderEdgesTest, AnEdgeAlongAnEdgeDoesNot) {
    EXPECT_FALSE(divides({-1, 0}, {5, 0}));
}
TEST_F(BorderEdgesTest, AnEdgeAlongPartOfTheLongEdgeDoesNot) {
    EXPECT_FALSE(divides({3, 1}, {1, 3}));
}
TEST_F(BorderEdgesTest, AnEdgeThatTouchesACornerDoesNot) {
    EXPECT_FALSE(divides({3, -1}, {5, 1}));
}
TEST_F(BorderEdgesTest, AnEdgeThatEndsOnAnEdgeDoesNot) {
    EXPECT_FALSE(divides({2, 2}, {7, 3}));
}
TEST_F(BorderEdgesTest, AnEdgeOnALineThroughTheInsideMayEndBefore) {
    EXPECT_FALSE(divides({2.5, 2.5}, {7, 7}));
}
TEST_F(BorderEdgesTest, AUnitInTheLastPlaceInsideDivides) {
    EXPECT_TRUE(divides({3, std::nextafter(1, 0)}, {1, 3}));
}
TEST_F(BorderEdgesTest, AUnitInTheLastPlaceOutsideDoesNot) {
    EXPECT_FALSE(divides({3, std::nextafter(1, 2)}, {1, 3}));
}

TEST(BorderEdges, RunBetweenPointsOfTheirs) {
    exact::PlanArrangement geometry;
    std::vector<VertexId> along;
    for (const double x : {0.0, 0.5, 1.0, 2.5, 3.0})
        along.push_back(geometry.add_vertex(x, 1));
    const VertexId beside = geometry.add_vertex(1, std::nextafter(1, 2));
    geometry.freeze_vertices();
    const PlanTiles tiles({0, 0, 4, 4}, 16);
    const BorderEdges borders(geometry, tiles, {{along[1], along[3]}});
    LocalArrangement scope(geometry);
    const TileSpan all{0, 3, 0, 3};
    const auto between = [&](VertexId a, VertexId b) {
        return borders.run_between(scope, a, b, all) && borders.run_between(scope, b, a, all);
    };
    EXPECT_TRUE(between(along[1], along[2]));
    EXPECT_TRUE(between(along[2], along[3]));
    EXPECT_TRUE(between(along[1], along[3]));
    EXPECT_FALSE(between(along[0], along[1]));
    EXPECT_FALSE(between(along[3], along[4]));
    EXPECT_FALSE(between(along[1], beside));
    EXPECT_FALSE(borders.run_between(scope, along[1], along[2], {0, 3, 2, 3}));  // elsewhere
}

TEST(BorderEdges, TilesKnowTheirs) {
    exact::PlanArrangement geometry;
    const VertexId a = geometry.add_vertex(0.5, 0.5), b = geometry.add_vertex(0.5, 2.5);
    geometry.freeze_vertices();
    const PlanTiles tiles({0, 0, 4, 4}, 16);
    const BorderEdges borders(geometry, tiles, {{a, b}});
    for (std::int32_t row = 0; row < 4; ++row) {
        for (std::int32_t column = 0; column < 4; ++column)
            EXPECT_EQ(borders.in_tile(tiles.tile(column, row)), column == 0 && row <= 2);
    }
    EXPECT_TRUE(borders.near({0, 3, 2, 3}));
    EXPECT_FALSE(borders.near({1, 3, 0, 3}));
}

}  // namespace
}  // namespace realmodel::strata
