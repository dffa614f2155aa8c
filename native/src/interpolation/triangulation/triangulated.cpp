// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <CGAL/function_objects.h>
#include <CGAL/natural_neighbor_coordinates_2.h>

#include <cmath>
#include <iterator>
#include <utility>

#include "interpolation/node_loop.hpp"
#include "interpolation/triangulation/point_triangulation.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

using Face = PointTriangulation::Face;
using Delaunay = PointTriangulation::Delaunay;

// Of the distances to the neighbors: where their weighted mean misses the node by more, the areas
// are rounding.
constexpr double kAreasAgree = 1e-7;

/// value(data, triangulation, node, face) for each node in a triangle; the border's value
/// elsewhere.
template <class Value>
std::vector<double> on_triangulation(std::span<const std::array<double, 3>> points,
                                     std::span<const Position> nodes, int threads,
                                     Progress* progress, const char* text, Value&& value) {
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    const PointTriangulation triangulation(data, progress);
    std::vector<double> z(nodes.size());
    const NodeLoop loop{nodes.size(), 256, threads, progress, text};
    loop.over_nodes(
        [] { return std::vector<spatial::Neighbor>(); },
        [&](std::vector<spatial::Neighbor>& found, std::size_t i) {
            const Position node = data.to_local(nodes[i]);
            Delaunay::Locate_type kind = Delaunay::OUTSIDE_AFFINE_HULL;
            int at = 0;
            Face face = triangulation.near(node, found);
            if (face != Face()) {
                face = triangulation.delaunay().locate({node[0], node[1]}, kind, at, face);
            }
            if (kind == Delaunay::VERTEX) {
                z[i] = data.values[face->vertex(at)->info()];
            } else if (kind == Delaunay::FACE || kind == Delaunay::EDGE) {
                if (triangulation.delaunay().is_infinite(face)) face = face->neighbor(at);
                z[i] = value(data, triangulation, node, face);
            } else {
                z[i] = triangulation.at_border(node);
            }
        });
    return z;
}

/// Sibson's coordinates, checked: their weighted mean must give the node back. As near to an edge
/// of the hull as rounding, an area may be infinite.
double natural(const DataPoints& data, const PointTriangulation& triangulation,
               const Position& node, Face face) {
    using Weight = std::pair<Delaunay::Vertex_handle, double>;
    thread_local std::vector<Weight> weights;
    weights.clear();
    CGAL::natural_neighbor_coordinates_2(
        triangulation.delaunay(), PointTriangulation::Kernel::Point_2(node[0], node[1]),
        std::back_inserter(weights), CGAL::Identity<Weight>(), face);
    double sum = 0, x = 0, y = 0, z = 0, reach = 0;
    const double base =
        weights.empty() ? 0 : data.values[static_cast<std::size_t>(weights.front().first->info())];
    for (const auto& [vertex, weight] : weights) {
        const auto point = vertex->info();
        const double dx = data.local[point][0] - node[0], dy = data.local[point][1] - node[1];
        sum += weight;
        x += weight * dx;
        y += weight * dy;
        z += weight * (data.values[point] - base);
        reach += weight * elementary::hypot(dx, dy);
    }
    if (!(sum > 0) || !std::isfinite(sum) || !(elementary::hypot(x, y) <= kAreasAgree * reach)) {
        return triangulation.linear(node, face);
    }
    return base + z / sum;
}

}  // namespace

std::vector<double> linear_on_triangulation(std::span<const std::array<double, 3>> points,
                                            std::span<const std::array<double, 2>> nodes,
                                            int threads, Progress* progress) {
    return on_triangulation(
        points, nodes, threads, progress, "linear interpolation",
        [](const DataPoints&, const PointTriangulation& triangulation, const Position& node,
           Face face) { return triangulation.linear(node, face); });
}

std::vector<double> natural_neighbors(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes, int threads,
                                      Progress* progress) {
    return on_triangulation(points, nodes, threads, progress, "natural neighbors", natural);
}

}  // namespace realmodel::interpolation
