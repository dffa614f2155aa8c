// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/edge_cutting.hpp"

#include <gtest/gtest.h>

#include "plan_mesh_checks.hpp"

namespace realmodel::meshing {
namespace {

const Check kNever = [](double) {};

EdgeCutting triangle_with(std::vector<PlanPoint> corners, const std::vector<PlanPoint>& more) {
    const std::vector<VertexSegment> edges{{0, 1}, {1, 2}, {2, 0}};
    const ConstrainedTriangulation mesh = constrained_delaunay(corners, edges);
    corners.insert(corners.end(), more.begin(), more.end());
    return {mesh, {true}, corners};
}

TEST(EdgeCutting, CutsAnEdgeAtAllItsPoints) {
    EdgeCutting cutting = triangle_with({{0, 0}, {4, 0}, {0, 4}}, {{1, 0}, {2, 0}, {3, 0}});
    cutting.cut(std::vector<CutEdge>{{{0, 1}, 3, 6}}, kNever);
    for (const std::int32_t point : {3, 4, 5})
        EXPECT_TRUE(cutting.has(point));
    EXPECT_FALSE(cutting.between(3, 4).is_none());
    EXPECT_TRUE(cutting.between(0, 1).is_none());
    const FlatMesh mesh = std::move(cutting).take_inside(1e-3, 1e-15);
    EXPECT_EQ(mesh.corners.size(), 4U);
    EXPECT_EQ(area_of({mesh.points, mesh.corners}), 8);
}

TEST(EdgeCutting, LeavesOutWhatHasNoRoom) {
    EdgeCutting cutting =
        triangle_with({{0, 0}, {1, 0}, {0.5, 1e-300}}, {{0.25, 1e-3}, {0.5, 0}, {0.75, 1e-3}});
    cutting.cut(std::vector<CutEdge>{{{0, 1}, 3, 6}}, kNever);
    EXPECT_FALSE(cutting.has(3));
    EXPECT_TRUE(cutting.has(4));
    EXPECT_FALSE(cutting.has(5));
}

TEST(EdgeCutting, TakesTheDoubleBesideIfThatHasRoom) {
    const double least = std::numeric_limits<double>::denorm_min();
    EdgeCutting cutting = triangle_with({{0, 0}, {1, 0}, {0.5, least}}, {{0.5, least}});
    cutting.cut(std::vector<CutEdge>{{{0, 1}, 3, 4}}, kNever);
    EXPECT_TRUE(cutting.has(3));
    EXPECT_EQ(cutting.mesh().points[3], (PlanPoint{0.5, 0}));
}

TEST(EdgeCutting, RoomIsMeasuredAtTheCutsNearestToTheEnds) {
    const EdgeCutting cutting = triangle_with({{0, 0}, {8, 0}, {4, 1}}, {});
    const HalfEdge edge = cutting.between(0, 1);
    EXPECT_TRUE(has_room(cutting.mesh(), edge, 1, 0.05));
    EXPECT_FALSE(has_room(cutting.mesh(), edge, 1, 0.07));  // 0.24 from the other edges
    EXPECT_TRUE(has_room(cutting.mesh(), edge, 4, 0.07));
    EXPECT_FALSE(has_room(cutting.mesh(), edge, 4, 0.3));
}

}  // namespace
}  // namespace realmodel::meshing
