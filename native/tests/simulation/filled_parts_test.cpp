// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/boundary_faces.hpp"
#include "simulation/corner_tetrahedra.hpp"
#include "simulation/edge_lengths.hpp"
#include "simulation/flat_tetrahedra.hpp"
#include "simulation/vertical_faults.hpp"
#include "towers.hpp"

namespace realmodel::simulation {
namespace {

TEST(BoundaryFacesTest, FacesBetweenRegionsAndSharpEdges) {
    const Tower tower({0, 5, 9});
    const std::vector<std::int32_t> apart{0, 1}, one{0, 0};
    const BoundaryFaces all = boundary_faces(tower.view, apart, {}, {1, nullptr});
    EXPECT_EQ(all.triangles.size(), 2u * 11);
    EXPECT_EQ(all.sharp_edges.size(), 20u);
    const BoundaryFaces outside = boundary_faces(tower.view, one, {}, {1, nullptr});
    EXPECT_EQ(outside.triangles.size(), 2u * 10);
    EXPECT_EQ(outside.sharp_edges.size(), 16u);  // its middle is no edge of one region
    for (const BoundaryTriangle& t : outside.triangles)
        EXPECT_EQ(t.behind + t.in_front, 1);
}

TEST(BoundaryFacesTest, PointsOnEdgesAreApart) {
    const Tower tower({0, 5});
    const std::vector<std::int32_t> region{0};
    const BoundaryFaces faces = boundary_faces(tower.view, region, {}, {1, nullptr});
    meshing::SizeField lengths(1);
    const auto points = points_on_edges(tower.view, faces.sharp_edges, lengths);
    EXPECT_GT(points.size(), 4u * (10 + 6 + 5) * 2 / 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_GE(length(minus(points[i], points[j])), 0.7);
    }
}

TEST(EdgeLengthsTest, CubesOfABox) {
    meshing::SizeField lengths(2);
    EXPECT_DOUBLE_EQ(cubes_in(lengths, {0, 0, 0}, {10, 4, 2}, 1e6, nullptr), 10);
}

/// A triangular bipyramid of two tetrahedra: of each three faces are outside.
FilledMesh bipyramid() {
    FilledMesh mesh;
    mesh.points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 4}, {1, 1, -4}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}};
    mesh.region = {0, 0};
    mesh.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
    mesh.surface = {0, 1, 2, 3, 4, 5};
    return mesh;
}

TEST(CornerTetrahedraTest, ElementsAreDividedUntilEachHasAnInnerFace) {
    FilledMesh mesh = bipyramid();
    EXPECT_DOUBLE_EQ(six_volumes(mesh, mesh.tetrahedra[0]), 64);
    EXPECT_EQ(rows_at(mesh, mesh.tetrahedra)[3].size(), 1u);
    EXPECT_EQ(rows_at(mesh, mesh.tetrahedra)[0].size(), 2u);
    divide_corner_tetrahedra(mesh, nullptr);
    EXPECT_EQ(mesh.points.size(), 6u);  // the middle of the face between them
    EXPECT_EQ(mesh.tetrahedra.size(), 6u);
    EXPECT_EQ(mesh.triangles.size(), 6u);
    double volume = 0;
    for (const auto& corners : mesh.tetrahedra)
        volume += six_volumes(mesh, corners);
    EXPECT_DOUBLE_EQ(volume, 128);
}

TEST(CornerTetrahedraTest, ATetrahedronAloneIsLeftOut) {
    FilledMesh mesh = bipyramid();
    mesh.tetrahedra.resize(1);
    mesh.region.resize(1);
    mesh.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
    mesh.surface.assign(4, 0);
    divide_corner_tetrahedra(mesh, nullptr);
    EXPECT_TRUE(mesh.tetrahedra.empty());
    EXPECT_TRUE(mesh.points.empty());
    EXPECT_TRUE(mesh.triangles.empty());
}

TEST(FlatTetrahedraTest, RoundnessOfARegularAndOfAFlatOne) {
    FilledMesh mesh;
    mesh.points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0.33, 0.33, -0.33}};
    EXPECT_NEAR(roundness(mesh, {0, 1, 2, 3}), 0.3, 0.01);
    EXPECT_LT(roundness(mesh, {0, 1, 2, 4}), 1e-3);
}

TEST(FlatTetrahedraTest, ACornerInsideMovesOutOfThePlaneOfTheOthers) {
    FilledMesh mesh = bipyramid();  // its upper half divided by a point next to its base
    mesh.points.push_back({1.3, 1.3, 0.001});
    mesh.tetrahedra = {{0, 2, 1, 4}, {0, 1, 2, 5}, {0, 1, 5, 3}, {1, 2, 5, 3}, {2, 0, 5, 3}};
    mesh.region.assign(5, 0);
    for (const auto& corners : mesh.tetrahedra)
        ASSERT_GT(six_volumes(mesh, corners), 0);
    EXPECT_EQ(thicken_flat_tetrahedra(mesh, 0.1, nullptr), 0u);
    EXPECT_GT(mesh.points[5][2], 0.1);
    EXPECT_EQ(mesh.points[3], (std::array<double, 3>{1, 1, 4}));
}

TEST(VerticalFaultsTest, TheFaultOfTheNearestFaceAtAHeight) {
    Tower tower({0, 5, 9});
    tower.surface[1] = 3;  // the wall of the lower box at y = 0
    const std::vector<std::array<PlanPoint, 2>> steps;
    const VerticalFaults faults(tower.view, steps);
    EXPECT_FALSE(faults.empty());
    EXPECT_EQ(faults.fault_at({2, 0.1}, {3, 0.1}, 2), 3);
    EXPECT_EQ(faults.fault_at({2, 0.1}, {3, 0.1}, 7), kWall);  // it ends at 5
    EXPECT_EQ(faults.fault_at({2, 3}, {3, 3}, 2), kWall);      // too far
    const std::vector<std::array<PlanPoint, 2>> nearer{{PlanPoint{0, 0.1}, PlanPoint{10, 0.1}}};
    EXPECT_EQ(VerticalFaults(tower.view, nearer).fault_at({2, 0.1}, {3, 0.1}, 2), kWall);
    EXPECT_TRUE(VerticalFaults(Tower({0, 5}).view, steps).empty());
}

}  // namespace
}  // namespace realmodel::simulation
