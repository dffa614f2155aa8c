// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "meshing/flat_mesh.hpp"
#include "plans.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {
namespace {

TEST(LineEdges, KnowTheSegmentOfEachEdgeFromBothEnds) {
    const PlanLines lines = halves(true);
    const LineEdges edges(lines, meshing::FlatMesh(fans()));
    EXPECT_EQ(edges.segment(1, 4), 6);
    EXPECT_EQ(edges.segment(4, 1), 6);
    EXPECT_EQ(edges.segment(5, 0), 5);
    EXPECT_EQ(edges.segment(1, 6), -1);  // within the rock
    EXPECT_EQ(edges.segment(0, 4), -1);  // both ends on lines, but no edge of the mesh
    EXPECT_TRUE(edges.is_step(1, 4));
    EXPECT_FALSE(edges.is_step(1, 6));
}

TEST(LineEdges, AnEdgeThatIsDividedHandsItsSegmentToBothParts) {
    const PlanLines lines = halves(false);
    LineEdges edges(lines, meshing::FlatMesh(fans()));
    edges.divide(4, 1, 8);
    EXPECT_EQ(edges.segment(4, 1), -1);
    EXPECT_EQ(edges.segment(1, 8), 6);
    EXPECT_EQ(edges.segment(8, 4), 6);
    edges.divide(1, 6, 9);  // of no line
    EXPECT_EQ(edges.segment(1, 9), -1);
}

TEST(LineEdges, ASegmentMayHaveSeveralEdges) {
    PlanLines lines = halves(false);
    meshing::PlanarMesh mesh = fans();
    mesh.vertices.push_back({2.5, 0});
    mesh.triangles[0] = {0, 8, 6};
    mesh.triangles.push_back({8, 1, 6});
    const LineEdges edges(lines, meshing::FlatMesh(mesh));
    EXPECT_EQ(edges.segment(0, 8), 0);
    EXPECT_EQ(edges.segment(8, 1), 0);
}

TEST(LineEdges, AMeshWithoutTheEndOfASegmentIsRefused) {
    PlanLines lines = halves(false);
    lines.points[2] = {10, 0.5};
    try {
        const LineEdges edges(lines, meshing::FlatMesh(fans()));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "bad_index");
        EXPECT_EQ(e.items, (std::vector<std::int64_t>{1}));
    }
}

}  // namespace
}  // namespace realmodel::simulation
