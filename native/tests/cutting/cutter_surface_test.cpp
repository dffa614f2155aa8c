// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../validation/small_complex.hpp"
#include "prism.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {
namespace {

double volume(const CutterSurface& surface) {
    const auto at = [&](std::int32_t v) { return surface.vertices[index(v)]; };
    double sixfold = 0;
    for (const auto& t : surface.triangles)
        sixfold += sixfold_volume({0, 0, 0}, at(t[0]), at(t[1]), at(t[2]));
    return sixfold / 6;
}

TEST(CutterSurface, ABlocksBoundaryTurnsOutward) {
    auto cubes = validation::two_cubes();
    for (const std::int32_t block : {0, 1}) {  // of the second, the face in common turns over
        const CutterSurface surface = block_boundary(cubes.view(), block);
        EXPECT_TRUE(surface.is_closed);
        EXPECT_EQ(surface.triangles.size(), 12U);
        EXPECT_EQ(surface.vertices.size(), 8U);
        EXPECT_DOUBLE_EQ(volume(surface), 1);
    }
    EXPECT_THROW(block_boundary(cubes.view(), 2), InputError);
}

TEST(CutterSurface, WithinABlockThereIsNoBoundary) {
    auto cubes = validation::two_cubes();
    cubes.block = {0, 0};
    const CutterSurface surface = block_boundary(cubes.view(), 0);
    EXPECT_EQ(surface.triangles.size(), 20U);
    EXPECT_DOUBLE_EQ(volume(surface), 2);
}

TEST(CutterSurface, AFaceThatIsNotConvexIsDividedWithinItself) {
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

TEST(CutterSurface, AWallBetweenTwoUprightLinesHasASideOnEach) {
    // on x = 1 corners at heights 0, 2, 3, and on x = 4 at 1, 5
    std::vector<double> vertices{1, 7, 2, 1, 7, 0, 4, 7, 1, 4, 7, 5, 1, 7, 3, 4, 7, 9};
    ComplexView model;
    model.vertices = vertices;
    std::vector<NodeId> corners;
    std::vector<NodeId> face{0, 1, 2, 3, 4};
    for (std::size_t turn = 0; turn < face.size(); ++turn) {
        const auto second = upright_sides(face, model, corners);
        ASSERT_TRUE(second);
        const bool west_first = corners[0] == 4;
        EXPECT_EQ(*second, west_first ? 3U : 2U);
        EXPECT_EQ(corners, west_first ? (std::vector<NodeId>{4, 0, 1, 2, 3})
                                      : (std::vector<NodeId>{2, 3, 4, 0, 1}));
        std::ranges::rotate(face, face.begin() + 1);
    }
    // a side that turns back, two that go up, and a corner elsewhere
    EXPECT_FALSE(upright_sides(std::array{4, 1, 0, 2, 3}, model, corners));
    EXPECT_FALSE(upright_sides(std::array{0, 4, 2, 3}, model, corners));
    vertices[0] = 1.5;
    EXPECT_FALSE(upright_sides(std::array{0, 1, 2, 3, 4}, model, corners));
}

}  // namespace
}  // namespace realmodel::cutting
