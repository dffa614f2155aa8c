// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facets.hpp"

#include <gtest/gtest.h>

#include "booleans/refinement.hpp"
#include "small_meshes.hpp"

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
    EXPECT_EQ(found.of_piece, (std::vector<std::int32_t>{0, 1, 0, 0}));
    EXPECT_EQ(found.first_piece, (std::vector<std::int32_t>{0, 1, 0, 0}));
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

struct FoundLoops {
    FoundLoops(const Mesh& p, const Mesh& q)
        : parts(refine({p.view(), q.view()}, {1})),
          mesh(facets_of(parts, {1})),
          loops(find_loops(mesh, parts.vertices.size(), {})) {}
    RefinedTriangles parts;
    FacetMesh mesh;
    IntersectionLoops loops;
};

TEST(IntersectionLoops, TwoSquaresThatCrossMeetAlongAPath) {
    const FoundLoops found(square({0, 0, 0}, 2), upright({1, 0, -1}, 2));
    ASSERT_EQ(found.loops.loops.size(), 1U);
    const IntersectionLoop& loop = found.loops.loops[0];
    EXPECT_EQ(loop.kind, LoopKind::kOpen);
    for (const std::int32_t v : loop.vertices) {
        EXPECT_EQ(found.parts.vertices[index(v)][0], 1);
        EXPECT_EQ(found.parts.vertices[index(v)][2], 0);
    }
    EXPECT_EQ(std::ranges::count_if(found.loops.of_edge, [](auto l) { return l == 0; }),
              std::ssize(loop.vertices) - 1);
}

TEST(IntersectionLoops, ACubeThroughASquareMakesOneThatCloses) {
    const FoundLoops found(square({0, 0, 0}, 9), cube({1, 1, -1}, 2));
    ASSERT_EQ(found.loops.loops.size(), 1U);
    EXPECT_EQ(found.loops.loops[0].kind, LoopKind::kHardClosed);
    EXPECT_EQ(std::ranges::count_if(found.loops.of_edge, [](auto l) { return l == 0; }),
              std::ssize(found.loops.loops[0].vertices));
}

TEST(IntersectionLoops, WithinAPartThatBothShareThereAreNone) {
    const FoundLoops found(square({0, 0, 0}, 2), square({0, 0, 0}, 2));
    EXPECT_TRUE(found.loops.loops.empty());
}

TEST(IntersectionLoops, SurfacesApartHaveNone) {
    EXPECT_TRUE(FoundLoops(square({0, 0, 0}, 2), square({0, 0, 1}, 2)).loops.loops.empty());
}

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
