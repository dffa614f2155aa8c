// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <map>

#include "../arrangement/small_polygons.hpp"
#include "cutting/plane_division.hpp"
#include "prism.hpp"

namespace realmodel::cutting {
namespace {

using Parts = std::map<NodeLoop, int>;  // with their sides

/// The parts of a prism's face at y = 0, which a plane cuts; new nodes are numbered in the order of
/// the edges, by their lesser and greater vertex.
Parts parts_of_front(validation::OwnedComplex prism, const Plane& plane) {
    const ComplexView model = prism.view();
    const auto oriented = checked_plane(plane);
    const auto sides = vertex_sides(model, oriented, {1, nullptr});
    std::vector<std::array<NodeId, 2>> edges;
    const auto& front = prism.loops[0];
    for (std::size_t i = 0; i < front.size(); ++i) {
        const std::int32_t a = front[i], b = front[(i + 1) % front.size()];
        if (sides[index(a)] * sides[index(b)] < 0) edges.push_back(unordered(NodeId{a}, NodeId{b}));
    }
    const EdgeIntersections cuts(model, oriented, edges);
    SplitFace parts;
    FaceSplitter(model, sides, cuts).split(NodeLoop(front.begin(), front.end()), parts);
    Parts found;
    for (std::size_t p = 0; p < parts.polygons.size(); ++p)
        found[from_least(parts.polygons[p])] = parts.sides[p];
    EXPECT_EQ(found.size(), parts.sides.size());
    return found;
}

const Outline kUnitOutline{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(FaceSplitting, TwoCutEdgesMakeTwoPartsThatTurnAsTheFace) {
    // nodes 8 and 9 on edges 0-3 and 1-2
    EXPECT_EQ(parts_of_front(prism(kUnitOutline), {{0, 0, 0.5}, {0, 0, 1}}),
              (Parts{{node_loop({0, 1, 9, 8}), kBelow}, {node_loop({9, 2, 3, 8}), kAbove}}));
}

TEST(FaceSplitting, ThroughCornersNoNodeIsNew) {
    EXPECT_EQ(parts_of_front(prism(kUnitOutline), {{0, 0, 0}, {-1, 0, 1}}),
              (Parts{{node_loop({0, 1, 2}), kBelow}, {node_loop({0, 2, 3}), kAbove}}));
    // through a corner and an edge
    EXPECT_EQ(parts_of_front(prism(kUnitOutline), {{0, 0, 0}, {-1, 0, 2}}),
              (Parts{{node_loop({0, 1, 8}), kBelow}, {node_loop({0, 8, 2, 3}), kAbove}}));
}

TEST(FaceSplitting, BothTowersOfAUAreParts) {
    // nodes 16 to 19 on edges 0-7, 1-2, 3-4 and 5-6
    EXPECT_EQ(parts_of_front(u_shape(), {{0, 0, 1.5}, {0, 0, 1}}),
              (Parts{{node_loop({0, 1, 17, 18, 4, 5, 19, 16}), kBelow},
                     {node_loop({17, 2, 3, 18}), kAbove},
                     {node_loop({19, 6, 7, 16}), kAbove}}));
}

TEST(FaceSplitting, AnEdgeInThePlaneStaysWithThePartBesideIt) {
    // nodes 16 and 17 on edges 0-7 and 1-2; the edge 4-5 lies in the plane
    EXPECT_EQ(parts_of_front(u_shape(), {{0, 0, 1}, {0, 0, 1}}),
              (Parts{{node_loop({0, 1, 17, 4, 5, 16}), kBelow},
                     {node_loop({17, 2, 3, 4}), kAbove},
                     {node_loop({5, 6, 7, 16}), kAbove}}));
}

}  // namespace
}  // namespace realmodel::cutting
