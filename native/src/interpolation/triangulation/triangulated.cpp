// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <CGAL/function_objects.h>
#include <CGAL/natural_neighbor_coordinates_2.h>

#include <algorithm>
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

using Point = PointTriangulation::Kernel::Point_2;

/// Whether a circle through a node and both ends of an edge has its center nowhere, for doubles.
bool has_no_center(const Point& node, const Delaunay::Edge& edge) {
    const auto corner = [&](int turned) {
        return edge.first->vertex((edge.second + turned) % 3)->point();
    };
    const auto is_flat = [&](const Point& p, const Point& q) {
        return (q.x() - p.x()) * (node.y() - p.y()) == (q.y() - p.y()) * (node.x() - p.x());
    };
    return is_flat(corner(1), corner(2)) || is_flat(corner(2), corner(1));
}

/// Appends Sibson's coordinates of a node, not normalized.
/// @return false where there are none: the node is as near to the border as rounding
template <class Weights>
bool add_weights(const Delaunay& delaunay, const Point& node, Face face, Weights& weights) {
    using Weight = typename Weights::value_type;
    Delaunay::Locate_type kind = Delaunay::FACE;
    int at = 0;
    face = delaunay.locate(node, kind, at, face);
    if (kind == Delaunay::EDGE &&
        (delaunay.is_infinite(face) || delaunay.is_infinite(face->neighbor(at)))) {
        CGAL::natural_neighbor_coordinates_2(delaunay, node, std::back_inserter(weights),
                                             CGAL::Identity<Weight>(), face);
        return true;
    }
    thread_local std::vector<Delaunay::Edge> hole;
    hole.clear();
    delaunay.get_boundary_of_conflicts(node, std::back_inserter(hole), face);
    if (std::ranges::any_of(hole, [&](const auto& edge) { return has_no_center(node, edge); }))
        return false;
    CGAL::natural_neighbor_coordinates_2(delaunay, node, std::back_inserter(weights),
                                         CGAL::Identity<Weight>(), hole.begin(), hole.end());
    return true;
}

/// Sibson's coordinates, checked: their weighted mean must give the node back.
double natural(const DataPoints& data, const PointTriangulation& triangulation,
               const Position& node, Face face) {
    using Weight = std::pair<Delaunay::Vertex_handle, double>;
    thread_local std::vector<Weight> weights;
    weights.clear();
    if (!add_weights(triangulation.delaunay(), {node[0], node[1]}, face, weights))
        return triangulation.linear(node, face);
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
