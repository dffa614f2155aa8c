// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/plan_topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "exact/orientation.hpp"
#include "plans.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {
namespace {

TEST(LineEdgesTest, ALineIsFoundOverTheNodesOnIt) {
    PlanLines lines;
    lines.points = {{0, 0}, {4, 0}};
    lines.segments = {{0, 1, 0, -1, true}};
    const meshing::FlatMesh mesh({{{0, 0}, {2, 0}, {4, 0}, {2, 3}}, {{0, 1, 3}, {1, 2, 3}}});
    LineEdges edges(lines, mesh);
    EXPECT_EQ(edges.segment(1, 0), 0);
    EXPECT_EQ(edges.segment(1, 2), 0);
    EXPECT_EQ(edges.segment(1, 3), -1);
    EXPECT_TRUE(edges.is_step(2, 1));
    edges.divide(1, 2, 4);
    edges.divide(1, 3, 5);
    EXPECT_EQ(edges.segment(1, 2), -1);
    EXPECT_EQ(edges.segment(4, 2), 0);
    EXPECT_EQ(edges.segment(1, 4), 0);
    EXPECT_EQ(edges.segment(1, 5), -1);
}

TEST(LineEdgesTest, AMeshWithoutTheEndOfALineIsRefused) {
    PlanLines lines;
    lines.points = {{0, 0}, {4, 1}};
    lines.segments = {{0, 1, 0, -1, true}};
    const meshing::FlatMesh mesh({{{0, 0}, {4, 0}, {2, 3}}, {{0, 1, 2}}});
    EXPECT_THROW(LineEdges(lines, mesh), InputError);
}

TEST(PillarsTest, AStepPartsTheSurroundingsOfItsNodes) {
    const meshing::FlatMesh mesh(fans());
    const PlanLines step = halves(true), line = halves(false);
    const Pillars pillars(mesh, LineEdges(step, mesh));
    EXPECT_EQ(pillars.node.size(), 10u);  // two more: nodes 1 and 4 have two
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        EXPECT_EQ(pillars.is_divided[n] != 0, n == 1 || n == 4);
        EXPECT_EQ(std::count(pillars.node.begin(), pillars.node.end(), n),
                  n == 1 || n == 4 ? 2 : 1);
    }
    EXPECT_EQ(Pillars(mesh, LineEdges(line, mesh)).node.size(), 8u);
}

TEST(PillarsTest, ANodeWhereTheRegionTouchesItselfHasTwo) {
    const PlanLines none;
    const meshing::FlatMesh mesh(
        {{{0, 0}, {2, 0}, {2, 2}, {-2, 0}, {-2, -2}}, {{0, 1, 2}, {0, 3, 4}}});
    const Pillars pillars(mesh, LineEdges(none, mesh));
    EXPECT_EQ(pillars.node.size(), 6u);
    EXPECT_EQ(pillars.is_divided, (std::vector<std::uint8_t>{1, 0, 0, 0, 0}));
}

TEST(PlanAdaptionTest, BorderCornersAreDivided) {
    const PlanLines none;
    for (const double far : {2.0, 9.0}) {  // an edge to there would be too sharp
        meshing::FlatMesh mesh({{{0, 0}, {1, -2}, {2, 0}, {1, far}, {4, 3}, {-2, 3}},
                                {{0, 1, 2}, {0, 2, 3}, {2, 4, 3}, {3, 5, 0}}});
        LineEdges edges(none, mesh);
        adapt_plan(mesh, edges);
        for (const auto& twins : mesh.twins)
            EXPECT_LT(std::count(twins.begin(), twins.end(), meshing::HalfEdge::none()), 2);
    }
}

TEST(PlanTopologyTest, TrianglesHaveOneStepAtMostAndOnePillarAcrossFromIt) {
    const PlanLines lines = halves(true, 0, 1);
    // no node is in the middle of the halves: all edges to the border lie between divided nodes
    PlanTopology plan(lines, {{{0, 0}, {5, 0}, {10, 0}, {10, 6}, {5, 6}, {0, 6}},
                              {{0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}}});
    std::set<std::int32_t> rocks;
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        const auto [a, b, c] = plan.corners(t);
        EXPECT_GT(exact::orient2d(plan.point(a), plan.point(b), plan.point(c)), 0);
        rocks.insert(plan.rock(t));
        EXPECT_EQ(plan.rock(t) == 0, plan.point(a)[0] + plan.point(b)[0] + plan.point(c)[0] < 15);
        for (std::size_t i = 0; i < 3; ++i) {
            if (!plan.is_inner_step(t, i)) continue;
            EXPECT_FALSE(plan.is_divided(plan.corners(t)[(i + 2) % 3]));
            const auto beyond = plan.pillars_beyond(t, i);
            EXPECT_NE(beyond[0], plan.pillar(t, i));
            EXPECT_EQ(plan.pillar_node(beyond[0]), plan.corners(t)[i]);
            EXPECT_EQ(plan.pillar_node(beyond[1]), plan.corners(t)[(i + 1) % 3]);
        }
    }
    EXPECT_EQ(rocks, (std::set<std::int32_t>{0, 1}));
}

}  // namespace
}  // namespace realmodel::simulation
