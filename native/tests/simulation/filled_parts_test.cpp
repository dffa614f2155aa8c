// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "base/vectors.hpp"
#include "simulation/boundary_faces.hpp"
#include "simulation/columns.hpp"
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
