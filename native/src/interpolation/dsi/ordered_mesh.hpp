// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interpolation/dsi/spline_grid.hpp"

namespace realmodel::interpolation {

/// A mesh in units of its mean edge, its nodes in the order of the cells of a grid of splines.
struct OrderedMesh {
    using Triangle = std::array<std::int32_t, 3>;

    SplineGrid grid;
    std::vector<std::size_t> first_in_cell;  ///< nodes of each cell of the grid, and their number
    std::vector<std::int32_t> old_number, new_number;
    std::vector<Position> nodes;
    std::vector<Triangle> triangles;
};

/// @param nodes, triangles  at least one of each, of valid indices
OrderedMesh ordered_mesh(std::span<const Position> nodes,
                         std::span<const OrderedMesh::Triangle> triangles);

}  // namespace realmodel::interpolation
