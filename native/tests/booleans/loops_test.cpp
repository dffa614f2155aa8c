// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/loops.hpp"

#include <gtest/gtest.h>

#include "booleans/refinement.hpp"
#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

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

}  // namespace
}  // namespace realmodel::booleans
