// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "interpolation/dsi/spline_grid.hpp"
#include "lattice.hpp"

namespace realmodel::interpolation {
namespace {

TEST(OrderedMesh, NodesByCellsInUnitsOfTheMeanEdge) {
    Lattice mesh = lattice(30, 20);
    for (auto& [x, y] : mesh.nodes) {
        x = 4e5 + 10 * x;
        y = 5e6 + 10 * y;
    }
    const OrderedMesh ordered = ordered_mesh(mesh.nodes, mesh.triangles);
    ASSERT_EQ(ordered.first_in_cell.size(), ordered.grid.cells() + 1);
    EXPECT_EQ(ordered.first_in_cell.back(), mesh.nodes.size());
    EXPECT_LE(ordered.grid.cells(), mesh.nodes.size());
    for (std::size_t cell = 0; cell < ordered.grid.cells(); ++cell) {
        for (std::size_t i = ordered.first_in_cell[cell]; i < ordered.first_in_cell[cell + 1];
             ++i) {
            EXPECT_EQ(ordered.grid.cell_of(ordered.nodes[i]), cell);
            EXPECT_EQ(ordered.new_number[ordered.old_number[i]], static_cast<std::int32_t>(i));
            if (i == ordered.first_in_cell[cell]) continue;
            EXPECT_LT(ordered.old_number[i - 1], ordered.old_number[i]);  // their old order
        }
    }
    double edges = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const std::int32_t a = ordered.triangles[t][k], b = ordered.triangles[t][(k + 1) % 3];
            EXPECT_EQ(ordered.old_number[a], mesh.triangles[t][k]);
            edges += std::hypot(ordered.nodes[a][0] - ordered.nodes[b][0],
                                ordered.nodes[a][1] - ordered.nodes[b][1]);
        }
    }
    EXPECT_NEAR(edges / (3 * static_cast<double>(mesh.triangles.size())), 1, 1e-9);
}

}  // namespace
}  // namespace realmodel::interpolation
