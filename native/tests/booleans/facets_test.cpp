// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facets.hpp"

#include <gtest/gtest.h>

namespace realmodel::booleans {
namespace {

/// Two triangles of P that share an edge, the first once more in Q, turned over, and twice in P.
FacetMesh mesh() {
    RefinedTriangles parts;
    parts.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    parts.triangles = {{{0, 1, 2}, 0, 0}, {{1, 3, 2}, 1, 0}, {{1, 2, 0}, 2, 0}, {{0, 2, 1}, 0, 1}};
    return facets_of(parts, {1});
}

TEST(Facets, PartsThatCoincideAreOne) {
    const FacetMesh found = mesh();
    EXPECT_EQ(found.of_part, (std::vector<std::int32_t>{0, 1, 0, 0}));
    EXPECT_EQ(found.first_part, (std::vector<std::int32_t>{0, 1, 0, 0}));
    ASSERT_EQ(found.facets.size(), 2U);
    EXPECT_EQ(found.facets[0].corners, (std::array{0, 1, 2}));
    EXPECT_EQ(found.facets[0].times, (std::array{2, -1}));
    EXPECT_EQ(found.facets[0].is_of, (std::array{true, true}));
    EXPECT_EQ(found.facets[1].is_of, (std::array{true, false}));
}

TEST(Facets, EdgesKnowTheirs) {
    const FacetMesh found = mesh();
    ASSERT_EQ(found.edges.size(), 5U);
    EXPECT_EQ(found.edges.ends(2), (std::array{1, 2}));
    ASSERT_EQ(found.edges[2].size(), 2U);
    EXPECT_EQ(found.edges[2][0].item, 0);
    EXPECT_EQ(found.edges[2][0].direction, 1);
    EXPECT_EQ(found.edges[2][1].direction, -1);
}

}  // namespace
}  // namespace realmodel::booleans
