// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/layered_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plane_models.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {
namespace {

TEST(LayeredMeshTest, LinesAreTheOutlineAndWhereALayerEnds) {
    const Model model({{0, 0}, {4, 4}, {2, 6}});  // the upper layer ends in the middle, x = 5
    const PlanLines lines = model.lines(1.5);
    ASSERT_EQ(lines.rings.size(), 1u);
    double ends = 0;
    for (std::size_t s = 0; s < lines.segments.size(); ++s) {
        const auto& [x, y] = lines.points[static_cast<std::size_t>(lines.segments[s].from)];
        const auto& [u, v] = lines.points[static_cast<std::size_t>(lines.segments[s].to)];
        if (lines.segments[s].left_rock < 0 || lines.segments[s].right_rock < 0) continue;
        EXPECT_FALSE(lines.segments[s].is_step);
        EXPECT_NEAR(x, 5, 1e-9);
        EXPECT_NEAR(u, 5, 1e-9);
        ASSERT_EQ(lines.ending_offsets[s + 1] - lines.ending_offsets[s], 1);
        EXPECT_EQ(lines.ending_blocks[static_cast<std::size_t>(lines.ending_offsets[s])], 1);
        ends += std::hypot(u - x, v - y);
    }
    EXPECT_NEAR(ends, 6, 1e-9);
}

TEST(LayeredMeshTest, PrismsBecomePyramidsAndTetrahedraWhereALayerEnds) {
    const Model model({{0, 0}, {4, 4}, {2, 6}});
    const LayeredMesh mesh = model.mesh(1.5, {0.001, {1, 1}, 0});
    // an end at the border, which solvers could not compute with, went to the layer below
    EXPECT_NEAR(mesh.volumes[0] + mesh.volumes[1], 4 * 60, 1e-7);
    EXPECT_NEAR(mesh.volumes[1], 2.0 / 2 * 5 * 6, 1.5);
    for (const std::int32_t block : mesh.pyramids.block)
        EXPECT_EQ(block, 1);
    EXPECT_GT(mesh.pyramids.corners.size(), 2u);
    EXPECT_GT(mesh.tetrahedra.corners.size(), 2u);
    EXPECT_EQ(std::count(mesh.prisms.block.begin(), mesh.prisms.block.end(), 0),
              static_cast<std::ptrdiff_t>(mesh.plan.triangles.size()));
}

TEST(LayeredMeshTest, NothingIsThinnerThanAsked) {
    const Model model({{0, 0}, {4, 4}, {2, 6}});
    const LayeredMesh mesh = model.mesh(1, {0.7, {8, 3}, 0});
    std::vector<std::array<double, 3>> points = mesh.points;
    std::sort(points.begin(), points.end());
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (points[i][0] == points[i - 1][0] && points[i][1] == points[i - 1][1]) {
            EXPECT_GE(points[i][2] - points[i - 1][2], 0.7 * (1 - 1e-9));
        }
    }
    EXPECT_NEAR(mesh.volumes[0] + mesh.volumes[1], 4 * 60, 1e-7);
    EXPECT_EQ(mesh.layers, 11);
}

TEST(LayeredMeshTest, AModelSmallerThanTheEdgeLengthIsRefused) {
    const Model model({{0, 0}, {4, 4}});
    try {
        model.lines(1000);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "nothing");
    }
}

TEST(LayeredMeshTest, BlocksOfOneRockMassStandTogether) {
    const Model model({{0, 0}, {4, 4}, {6, 6}, {8, 8}});
    const std::vector<std::int32_t> mixed{0, 1, 0};
    EXPECT_THROW(plan_lines(model.view, mixed, 1, {}, {1, nullptr}), InputError);
}

TEST(LayeredMeshTest, ThinLayersEndAtSteepWalls) {
    const Model model({{0, 50}, {30, 80}, {30.3, 80.3}, {60, 110}});
    for (const bool divided : {false, true}) {
        const LayeredMesh mesh = model.mesh(1.5, {0.1, {2, 1, 2}, 0, divided});
        EXPECT_EQ(mesh.skewed.faces, 0u);
        EXPECT_LT(mesh.volumes[1], 0.95 * 18);
        EXPECT_GT(mesh.volumes[1], 0.5 * 18);  // it stays where it goes on evenly
        EXPECT_NEAR(mesh.volumes[0] + mesh.volumes[1] + mesh.volumes[2], 3600, 1e-6);
    }
}

TEST(LayeredMeshTest, LayersOfOneBlockJoinAtSteepWallsWithoutLoss) {
    const Model model({{0, 50}, {10, 60}});
    const LayeredMesh mesh = model.mesh(1.5, {0.1, {50}, 0});
    EXPECT_EQ(mesh.skewed.faces, 0u);
    EXPECT_NEAR(mesh.volumes[0], 600, 1e-7);
    EXPECT_EQ(mesh.layers, 50);
}

TEST(LayeredMeshTest, BlocksThatAreTooTallForTheirTopAreDividedUnlessAskedOtherwise) {
    const Model model({{0, 0}, {40, 70}});
    const LayeredMesh free = model.mesh(1, {0.1, {0}, 0});
    EXPECT_EQ(free.skewed.faces, 0u);
    EXPECT_GT(free.block_layers[0], 1);
    EXPECT_EQ(free.layers, free.block_layers[0]);
    const LayeredMesh one = model.mesh(1, {0.1, {1}, 0});
    EXPECT_EQ(one.block_layers[0], 1);
    EXPECT_GT(one.skewed.faces, 0u);
    EXPECT_GT(one.skewed.most, 4);
    EXPECT_EQ(one.skewed.tall, std::vector<std::int32_t>{0});
}

TEST(LayeredMeshTest, AThinSteepModelSaysHowSkewItsFacesAre) {
    const Model model({{0, 80}, {0.3, 80.3}});
    const LayeredMesh mesh = model.mesh(1.5, {0.1, {1}, 0});
    EXPECT_GT(mesh.skewed.faces, 0u);
    EXPECT_TRUE(mesh.skewed.tall.empty());
    const double x = mesh.skewed.place[0];
    EXPECT_TRUE(x == 0 || x == 10) << x;
}

}  // namespace
}  // namespace realmodel::simulation
