// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "cutting/assembly.hpp"

namespace realmodel::cutting {
namespace {

Position position_of(NodeId node) {
    return {static_cast<double>(node), 0, 0};
}

TEST(ChunkedComplex, NumbersNodesAsTheyComeUpInOneChunkAfterAnother) {
    CellComplex to;
    ChunkedComplex faces(to, 2);
    faces.count(0, 3);
    faces.count(1, 4);
    faces.make_room();
    // the second chunk may be written first
    ChunkedComplex::Writer(faces, 1).write(std::vector<NodeId>{7, 2, 9, 4}, {0, 1}, 5);
    ChunkedComplex::Writer(faces, 0).write(std::vector<NodeId>{9, 3, 7}, {1, -1}, 6);
    number_nodes(to.face_vertices, 10, position_of, to.vertices);
    EXPECT_EQ(to.face_offsets, (Array<std::int64_t>{0, 3, 7}));
    EXPECT_EQ(to.face_vertices, (Array<std::int32_t>{0, 1, 2, 2, 3, 0, 4}));
    EXPECT_EQ(to.face_surface, (Array<std::int32_t>{6, 5}));
    ASSERT_EQ(to.vertices.size(), 5U);
    const std::array<double, 5> nodes{9, 3, 7, 2, 4};
    for (std::size_t v = 0; v < 5; ++v)
        EXPECT_EQ(to.vertices[v][0], nodes[v]);
}

TEST(ChunkedComplex, AFaceWithNothingBehindItIsTurnedAround) {
    CellComplex to;
    ChunkedComplex faces(to, 1);
    faces.count(0, 3);
    faces.make_room();
    ChunkedComplex::Writer(faces, 0).write(std::vector<NodeId>{0, 1, 2}, {-1, 8}, 0);
    number_nodes(to.face_vertices, 3, position_of, to.vertices);
    EXPECT_EQ(to.face_cells[0], (std::array<std::int32_t, 2>{8, -1}));
    EXPECT_EQ(to.vertices[0][0], 2);
    EXPECT_EQ(to.vertices[2][0], 0);
}

}  // namespace
}  // namespace realmodel::cutting
