// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/ordered_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"

namespace realmodel::interpolation {

namespace {

constexpr double kCellInEdges = 2;

double mean_edge(std::span<const Position> nodes,
                 std::span<const OrderedMesh::Triangle> triangles) {
    double sum = 0;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum += distance(nodes[t[k]], nodes[t[(k + 1) % 3]]);
        }
    }
    const double mean = sum / (3 * static_cast<double>(triangles.size()));
    return mean > 0 ? mean : 1;
}

}  // namespace

OrderedMesh ordered_mesh(std::span<const Position> nodes,
                         std::span<const OrderedMesh::Triangle> triangles) {
    const spatial::PlanBox box = spatial::box_around(nodes);
    const double unit = mean_edge(nodes, triangles);
    const double width = box.width() / unit, height = box.height() / unit;
    const auto count = static_cast<double>(nodes.size());
    // No more cells than nodes, where the region fills little of its box.
    const double cell = std::max(
        {kCellInEdges, std::sqrt(width * height / count), std::max(width, height) / count});
    const auto cells = [&](double length) {
        return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length / cell)));
    };
    const SplineGrid grid({0, 0}, cell, cells(width), cells(height));
    const auto to_mesh = [&](const Position& p) {
        return Position{(p[0] - box.low_x) / unit, (p[1] - box.low_y) / unit};
    };
    const auto by_cell = bucketize<std::int32_t>(grid.cells(), [&](const auto& visit) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            visit(grid.cell_of(to_mesh(nodes[i])), static_cast<std::int32_t>(i));
    });
    OrderedMesh mesh{grid,
                     {by_cell.offsets.begin(), by_cell.offsets.end()},
                     {by_cell.values.begin(), by_cell.values.end()},
                     {},
                     {},
                     {}};
    mesh.new_number.resize(nodes.size());
    for (const std::int32_t old : mesh.old_number) {
        mesh.new_number[old] = static_cast<std::int32_t>(mesh.nodes.size());
        mesh.nodes.push_back(to_mesh(nodes[old]));
    }
    for (const auto& t : triangles) {
        mesh.triangles.push_back(
            {mesh.new_number[t[0]], mesh.new_number[t[1]], mesh.new_number[t[2]]});
    }
    return mesh;
}

}  // namespace realmodel::interpolation
