// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <numeric>

#include "realmodel/base/errors.hpp"
#include "realmodel/shells/shells.hpp"

namespace realmodel::shells {
namespace {

using Edges = std::vector<std::array<std::int32_t, 2>>;
using Numbers = std::vector<std::int32_t>;

TEST(PolygonEdges, NeighborsShareAnEdge) {
    // two triangles of a square
    const PolygonEdges found = polygon_edges(Numbers{0, 3, 6}, Numbers{0, 1, 2, 0, 2, 3}, 4);
    EXPECT_EQ(found.edges, (Edges{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {2, 3}}));
    EXPECT_EQ(found.of_corner, (Numbers{0, 3, 1, 1, 4, 2}));
}

TEST(PolygonEdges, AnEdgeOfOnePolygonIsThereOnce) {
    const PolygonEdges found = polygon_edges(Numbers{0, 4}, Numbers{3, 2, 1, 0}, 4);
    EXPECT_EQ(found.edges.size(), 4U);
    for (std::size_t c = 0; c < 4; ++c) {
        const std::int32_t lower = c == 3 ? 0 : static_cast<std::int32_t>(2 - c);
        EXPECT_EQ(found.edges[static_cast<std::size_t>(found.of_corner[c])][0], lower);
    }
}

TEST(PolygonEdges, AFanRoundAVertexHasEachSpokeOnce) {
    const PolygonEdges found =
        polygon_edges(Numbers{0, 3, 6, 9}, Numbers{0, 1, 2, 0, 2, 3, 0, 3, 1}, 4);
    EXPECT_EQ(found.edges.size(), 6U);
    EXPECT_EQ(found.of_corner[8], found.of_corner[0]);  // from 1 to 0, and from 0 to 1
}

TEST(PolygonEdges, NoPolygonsHaveNone) {
    const PolygonEdges found = polygon_edges(Numbers{0}, Numbers{}, 3);
    EXPECT_TRUE(found.edges.empty());
    EXPECT_TRUE(found.of_corner.empty());
}

std::int64_t refused(const Numbers& offsets, const Numbers& corners) {
    try {
        polygon_edges(offsets, corners, 4);
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "bad_index");
        return error.items.at(0);
    }
    return -1;
}

TEST(PolygonEdges, RefusesNumbersOutOfRangeUnderThePolygons) {
    EXPECT_EQ(refused({0, 3, 6}, {0, 1, 2, 0, 2, 3}), -1);
    EXPECT_EQ(refused({0, 3, 6}, {0, 1, 2, 0, 2, 4}), 1);
    EXPECT_EQ(refused({0, 3, 6}, {0, -1, 2, 0, 2, 3}), 0);
    EXPECT_EQ(refused({0, 3, 7}, {0, 1, 2, 0, 2, 3}), 1);
    EXPECT_EQ(refused({0, 3, 2}, {0, 1, 2}), 1);
    EXPECT_EQ(refused({0, 3}, {0, 1, 2, 3}), 1);  // a corner beyond the last
    EXPECT_EQ(refused({1, 3}, {0, 1, 2}), 0);
    EXPECT_EQ(refused({}, {}), 0);
}

}  // namespace
}  // namespace realmodel::shells
