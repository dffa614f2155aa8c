// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "meshing/flat_mesh.hpp"
#include "simulation/line_edges.hpp"

namespace realmodel::simulation {

/// Steps, and the border where it touches itself, divide the surroundings of a node into parts.
/// Each part has a post.
struct Posts {
    std::vector<std::int32_t> of_corner;  ///< 3 a triangle
    std::vector<std::int32_t> node;       ///< of each post
    /// Of each node: whether it may have heights that are not of all its triangles. It is an end of
    /// an edge on a step with triangles on both sides, or has several posts.
    std::vector<std::uint8_t> is_divided;

    Posts() = default;
    Posts(const meshing::FlatMesh& mesh, const LineEdges& edges);
};

}  // namespace realmodel::simulation
