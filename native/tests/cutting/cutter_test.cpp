// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter.hpp"

#include <gtest/gtest.h>

#include "../validation/small_complex.hpp"
#include "prism.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {
namespace {

double volume(const Cutter& surface) {
    const auto at = [&](std::int32_t v) { return surface.vertices[index(v)]; };
    double sixfold = 0;
    for (const auto& t : surface.triangles)
        sixfold += sixfold_volume({0, 0, 0}, at(t[0]), at(t[1]), at(t[2]));
    return sixfold / 6;
}

TEST(Cutter, ABlocksBoundaryTurnsOutward) {
    auto cubes = validation::two_cubes();
    for (const std::int32_t block : {0, 1}) {  // of the second, the face in common turns over
        const Cutter surface = block_boundary(cubes.view(), block);
        EXPECT_TRUE(surface.is_closed);
        EXPECT_EQ(surface.triangles.size(), 12U);
        EXPECT_EQ(surface.vertices.size(), 8U);
        EXPECT_DOUBLE_EQ(volume(surface), 1);
    }
    EXPECT_THROW(block_boundary(cubes.view(), 2), InputError);
}

TEST(Cutter, WithinABlockThereIsNoBoundary) {
    auto cubes = validation::two_cubes();
    cubes.block = {0, 0};
    const Cutter surface = block_boundary(cubes.view(), 0);
    EXPECT_EQ(surface.triangles.size(), 20U);
    EXPECT_DOUBLE_EQ(volume(surface), 2);
}

TEST(Cutter, AFaceThatIsNotConvexIsDividedWithinItself) {
    auto u = u_shape();
    std::vector<std::array<std::int32_t, 3>> triangles;
    triangulate_face(u.view(), 0, triangles);
    EXPECT_EQ(triangles.size(), 6U);
    double area = 0;
    for (const auto& t : triangles) {
        const Position normal = polygon_normal(
            std::array{u.vertices[index(t[0])], u.vertices[index(t[1])], u.vertices[index(t[2])]});
        EXPECT_LT(normal[1], 0);  // as the face turns
        area -= normal[1] / 2;
    }
    EXPECT_DOUBLE_EQ(area, 5);
    Polygons polygons;
    divide_face(u.view(), 0, polygons);
    EXPECT_EQ(polygons.size(), 3U);  // the foot and the towers
}

}  // namespace
}  // namespace realmodel::cutting
