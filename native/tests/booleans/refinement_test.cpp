// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/refinement.hpp"

#include <gtest/gtest.h>

#include "base/index.hpp"
#include "realmodel/base/errors.hpp"
#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

TEST(Refinement, WhatMeetsInOrderStaysAsItIs) {
    const Mesh p = square({0, 0, 0}, 2), q = square({0, 0, 1}, 2);
    const RefinedTriangles parts = refine({p.view(), q.view()}, {1});
    EXPECT_EQ(parts.vertices.size(), 8U);
    EXPECT_EQ(parts.triangles,
              (std::vector<RefinedTriangle>{
                  {{0, 1, 2}, 0, 0}, {{1, 3, 2}, 1, 0}, {{4, 5, 6}, 0, 1}, {{5, 7, 6}, 1, 1}}));
}

TEST(Refinement, PartsKnowWhatTheyArePartOfAndHowItTurns) {
    const Mesh p = square({0, 0, 0}, 2), q = upright({0.5, -1, -1}, 4);
    const RefinedTriangles parts = refine({p.view(), q.view()}, {1});
    double area = 0;
    for (const RefinedTriangle& part : parts.triangles) {
        if (part.source != 0) continue;
        EXPECT_LT(part.origin, 2);
        std::array<Position, 3> at;
        for (std::size_t k = 0; k < 3; ++k)
            at[k] = parts.vertices[index(part.corners[k])];
        const double own = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                           (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
        EXPECT_GT(own, 0);
        area += own;
    }
    EXPECT_DOUBLE_EQ(area, 8);
}

TEST(Refinement, ATriangleWithoutAreaIsLeftOut) {
    Mesh p = square({0, 0, 0}, 2);
    p.triangles.insert(p.triangles.end(), {0, 1, 1});
    const Mesh q = square({0, 0, 1}, 2);
    EXPECT_EQ(refine({p.view(), q.view()}, {1}).triangles.size(), 4U);
}

TEST(Refinement, RefusesWhatIsNoSurface) {
    const auto refusal = [](const Mesh& mesh) -> std::pair<std::string, int> {
        const Mesh good = square({0, 0, 0}, 2);
        try {
            refine({good.view(), mesh.view()}, {1});
        } catch (const InputError& error) {
            return {error.kind, error.surface};
        }
        return {};
    };
    EXPECT_EQ(refusal({}), std::pair(std::string("no_triangles"), 1));
    EXPECT_EQ(refusal({{0, 0, 0}, {0, 0, 1}}), std::pair(std::string("bad_index"), 1));
    EXPECT_EQ(refusal({{0, 0, NAN, 1, 0, 0, 0, 1, 0}, {0, 1, 2}}),
              std::pair(std::string("not_finite"), 1));
}

}  // namespace
}  // namespace realmodel::booleans
