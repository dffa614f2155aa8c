// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facet_cells.hpp"

#include <gtest/gtest.h>

#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

using Winding = std::array<std::int32_t, 2>;

struct Found {
    Found(const Mesh& p, const Mesh& q)
        : parts(refine({p.view(), q.view()}, {1})),
          mesh(facets_of(parts, {1})),
          cells(cells_of(parts.vertices, mesh, {1})) {}
    std::vector<Winding> windings() const {
        std::vector<Winding> sorted = cells.winding;
        std::sort(sorted.begin() + 1, sorted.end());
        return sorted;
    }
    RefinedTriangles parts;
    FacetMesh mesh;
    FacetCells cells;
};

TEST(FacetCells, TwoCubesThatOverlapLeaveThreeAndTheOutside) {
    const Found found(cube({0, 0, 0}, 2), cube({1, 1, 1}, 2));
    EXPECT_EQ(found.windings(), (std::vector<Winding>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
}

TEST(FacetCells, WhatDoesNotTouchIsFoundByARay) {
    const Found within(cube({0, 0, 0}, 9), cube({1, 1, 1}, 2));
    EXPECT_EQ(within.windings(), (std::vector<Winding>{{0, 0}, {1, 0}, {1, 1}}));
    const Found beside(cube({0, 0, 0}, 2), cube({1, 1, 7}, 2));
    EXPECT_EQ(beside.windings(), (std::vector<Winding>{{0, 0}, {0, 1}, {1, 0}}));
}

TEST(FacetCells, ARayThatHitsAnEdgeIsTriedAgain) {
    // from (1, 1, 0), the middle of the first triangle, up to a diagonal of the upper cube
    const Found found(cube({0, 0, 0}, 3), cube({0, 0, 5}, 2));
    EXPECT_EQ(found.windings(), (std::vector<Winding>{{0, 0}, {0, 1}, {1, 0}}));
}

TEST(FacetCells, OfManyPartsATreeFindsThemAll) {
    Mesh many;
    for (int i = 0; i < 30; ++i)
        many.add(cube({3.0 * i, 0.1 * i, 0}, 2));
    const Found found(many, cube({-1, -1, -1}, 100));
    std::vector<Winding> expected{{0, 0}, {0, 1}};
    expected.resize(32, {1, 1});
    EXPECT_EQ(found.windings(), expected);
}

TEST(FacetCells, AnOpenSurfaceDividesNothing) {
    const Found found(square({0, 0, 0}, 2), square({0, 0, 1}, 2));
    EXPECT_EQ(found.cells.size(), 1U);
    for (const auto& sides : found.cells.of_facet)
        EXPECT_EQ(sides, (std::array{0, 0}));
}

TEST(FacetCells, OneThatIsTurnedOverGoesRoundMinusOnce) {
    Mesh inside_out = cube({5, 0, 0}, 2);
    for (std::size_t t = 0; t < inside_out.triangles.size(); t += 3)
        std::swap(inside_out.triangles[t], inside_out.triangles[t + 1]);
    const Found found(cube({0, 0, 0}, 2), inside_out);
    EXPECT_EQ(found.windings(), (std::vector<Winding>{{0, 0}, {0, -1}, {1, 0}}));
}

}  // namespace
}  // namespace realmodel::booleans
