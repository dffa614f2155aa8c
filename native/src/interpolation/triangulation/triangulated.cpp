// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "interpolation/node_loop.hpp"
#include "interpolation/triangulation/part_check.hpp"
#include "interpolation/triangulation/point_triangulation.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

namespace {

using Face = PointTriangulation::Face;
using Delaunay = PointTriangulation::Delaunay;
using Edge = Delaunay::Edge;
using Kernel = PointTriangulation::Kernel;
using Point = Kernel::Point_2;

// Of the distances to the neighbors: where their weighted mean misses the node by more, the areas
// are rounding.
constexpr double kAreasAgree = 1e-7;

/// What a value follows from. check: whether a part of the points suffices; null where there are
/// all.
struct Source {
    const DataPoints& data;
    const PointTriangulation& triangulation;
    const PartCheck* check;

    const Delaunay& delaunay() const { return triangulation.delaunay(); }
    std::int32_t number(const Edge& edge, int turned) const {
        return edge.first->vertex((edge.second + turned) % 3)->info();
    }
    bool circle_suffices(const Position& p, std::int32_t a, std::int32_t b) const {
        return check == nullptr || check->has_all_in_circle(p, data.local[a], data.local[b]);
    }
    bool triangle_suffices(Face face) const {
        const auto [a, b, c] = triangulation.corners(face);
        return circle_suffices(data.local[a], b, c) || circle_suffices(data.local[b], c, a) ||
               circle_suffices(data.local[c], a, b);
    }
};

/// Where a node is. face: a finite triangle; on an edge between two, the one whose other corner has
/// the lower number: it does not matter then in which order points were inserted. from, to: the
/// numbers of the ends of the edge, ascending.
struct Place {
    Face face, other;  ///< other: of an edge
    bool is_on_edge = false, is_on_hull = false;
    std::int32_t from = 0, to = 0;
};

Place place_of(const Delaunay& delaunay, Delaunay::Locate_type kind, Face face, int at) {
    Place place;
    place.face = face;
    if (kind == Delaunay::FACE) return place;
    place.is_on_edge = true;
    place.other = face->neighbor(at);
    const auto number = [](Face f, int i) { return f->vertex(i)->info(); };
    place.from = std::min(number(face, Delaunay::cw(at)), number(face, Delaunay::ccw(at)));
    place.to = std::max(number(face, Delaunay::cw(at)), number(face, Delaunay::ccw(at)));
    place.is_on_hull = delaunay.is_infinite(face) || delaunay.is_infinite(place.other);
    const bool other_first = place.is_on_hull
                                 ? delaunay.is_infinite(face)
                                 : number(place.other, place.other->index(face)) < number(face, at);
    if (other_first) std::swap(place.face, place.other);
    return place;
}

/// Whether triangles that a value on a place follows from are those of all points.
bool suffices(const Source& source, const Place& place) {
    if (source.check == nullptr || source.check->is_whole()) return true;
    if (place.is_on_hull)
        return source.check->is_hull_edge(source.data.local[place.from],
                                          source.data.local[place.to]) &&
               source.triangle_suffices(place.face);
    return source.triangle_suffices(place.face) &&
           (!place.is_on_edge || source.triangle_suffices(place.other));
}

/// A value, and whether the points suffice for it.
struct Found {
    double value;
    bool is_certain;
};

Found linear(const Source& source, const Position& node, const Place& place) {
    return {source.triangulation.linear(node, place.face), suffices(source, place)};
}

/// value(source, node, place) for each node in a triangle; the border's value elsewhere. around:
/// null where there are all points.
template <class Value>
PartValues on_triangulation(std::span<const std::array<double, 3>> points,
                            std::span<const Position> nodes, const PointsAround* around,
                            const Execution& execution, const char* text, Value&& value) {
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    const PointTriangulation triangulation(data, execution.progress);
    std::optional<PartCheck> check;
    if (around != nullptr) check.emplace(data, *around);
    const Source source{data, triangulation, check ? &*check : nullptr};
    PartValues out{std::vector<double>(nodes.size()), std::vector<std::uint8_t>(nodes.size(), 1)};
    const NodeLoop loop{nodes.size(), 256, execution, text};
    loop.over_nodes(
        [] { return std::vector<spatial::Neighbor>(); },
        [&](std::vector<spatial::Neighbor>& found, std::size_t i) {
            const Position node = data.to_local(nodes[i]);
            if (check && !check->in_hull(node)) {
                out.z[i] = check->border().nearest_value(node);
                return;
            }
            Delaunay::Locate_type kind = Delaunay::OUTSIDE_AFFINE_HULL;
            int at = 0;
            Face face = triangulation.near(node, found);
            if (face != Face()) {
                face = triangulation.delaunay().locate({node[0], node[1]}, kind, at, face);
            }
            if (kind == Delaunay::VERTEX) {
                out.z[i] = data.values[face->vertex(at)->info()];
            } else if (kind == Delaunay::FACE || kind == Delaunay::EDGE) {
                const Place place = place_of(triangulation.delaunay(), kind, face, at);
                const Found here = value(source, node, place);
                out.z[i] = here.value;
                out.certain[i] = here.is_certain ? 1 : 0;
            } else {
                out.z[i] = triangulation.border().nearest_value(node);
                out.certain[i] = !check || check->is_whole() ? 1 : 0;
            }
        });
    return out;
}

/// Whether a circle through a node and both ends of an edge has its center nowhere, for doubles.
bool has_no_center(const Point& node, const Edge& edge) {
    const auto corner = [&](int turned) {
        return edge.first->vertex((edge.second + turned) % 3)->point();
    };
    const auto is_flat = [&](const Point& p, const Point& q) {
        return (q.x() - p.x()) * (node.y() - p.y()) == (q.y() - p.y()) * (node.x() - p.x());
    };
    return is_flat(corner(1), corner(2)) || is_flat(corner(2), corner(1));
}

using Weights = std::vector<std::pair<std::int32_t, double>>;  // by number of the point

/// On an edge of the hull only its ends count.
void add_weights_on_hull(const Source& source, const Position& node, const Place& place,
                         Weights& weights) {
    const Position &from = source.data.local[place.from], &to = source.data.local[place.to];
    const std::size_t axis = from[0] != to[0] ? 0 : 1;
    const double share = (node[axis] - to[axis]) / (from[axis] - to[axis]);
    weights.emplace_back(place.from, share);
    weights.emplace_back(place.to, 1 - share);
}

/// Sibson's coordinates, not normalized: of each point around the hole that the node would make
/// into the triangulation, the area between the centers of the circles that go and those that come.
/// Their digits depend on the points alone: circles that go are taken from their corners in order,
/// and the hole begins at its point with the lowest number.
/// @return false where there are none: the node is as near to the border as rounding
bool add_weights(const Source& source, const Point& node, std::vector<Edge>& hole,
                 Weights& weights) {
    if (std::ranges::any_of(hole, [&](const Edge& edge) { return has_no_center(node, edge); }))
        return false;
    const auto end_of = [&](const Edge& edge) { return source.number(edge, 2); };
    std::rotate(
        hole.begin(),
        std::min_element(hole.begin(), hole.end(),
                         [&](const Edge& a, const Edge& b) { return end_of(a) < end_of(b); }),
        hole.end());
    const Kernel kernel;
    const auto center = kernel.construct_circumcenter_2_object();
    const auto area_of = kernel.compute_area_2_object();
    const auto at = [&](std::int32_t number) {
        const Position& local = source.data.local[number];
        return Point(local[0], local[1]);
    };
    const auto center_of = [&](Face face) {
        const auto [a, b, c] = source.triangulation.corners(face);
        return center(at(a), at(b), at(c));
    };
    Delaunay::Vertex_handle before = hole.back().first->vertex(Delaunay::cw(hole.back().second));
    for (const Edge& edge : hole) {
        const Delaunay::Vertex_handle current = edge.first->vertex(Delaunay::cw(edge.second));
        const Point first =
            center(current->point(), edge.first->vertex(Delaunay::ccw(edge.second))->point(), node);
        auto face = source.delaunay().incident_faces(current, edge.first);
        ++face;
        Point last = center_of(face);
        double area = 0;
        while (!face->has_vertex(before)) {
            ++face;
            const Point next = center_of(face);
            area += area_of(first, last, next);
            last = next;
        }
        area += area_of(first, last, center(before->point(), current->point(), node));
        if (area > 0) weights.emplace_back(current->info(), area);
        before = current;
    }
    return true;
}

/// Sibson's coordinates, checked: their weighted mean must give the node back.
Found natural(const Source& source, const Position& node, const Place& place) {
    thread_local Weights weights;
    thread_local std::vector<Edge> hole;
    weights.clear();
    bool is_certain = true;
    if (place.is_on_hull) {
        add_weights_on_hull(source, node, place, weights);
        is_certain = suffices(source, place);
    } else {
        hole.clear();
        const Point point(node[0], node[1]);
        source.delaunay().get_boundary_of_conflicts(point, std::back_inserter(hole), place.face);
        for (const Edge& edge : hole) {
            is_certain = is_certain && source.circle_suffices(node, source.number(edge, 1),
                                                              source.number(edge, 2));
        }
        if (!add_weights(source, point, hole, weights)) return linear(source, node, place);
    }
    const DataPoints& data = source.data;
    double sum = 0, x = 0, y = 0, z = 0, reach = 0;
    const double base = weights.empty() ? 0 : data.values[weights.front().first];
    for (const auto& [number, weight] : weights) {
        const double dx = data.local[number][0] - node[0], dy = data.local[number][1] - node[1];
        sum += weight;
        x += weight * dx;
        y += weight * dy;
        z += weight * (data.values[number] - base);
        reach += weight * elementary::hypot(dx, dy);
    }
    if (!(sum > 0) || !std::isfinite(sum) || !(elementary::hypot(x, y) <= kAreasAgree * reach)) {
        const Found plain = linear(source, node, place);
        return {plain.value, plain.is_certain && is_certain};
    }
    return {base + z / sum, is_certain};
}

}  // namespace

std::vector<double> linear_on_triangulation(std::span<const std::array<double, 3>> points,
                                            std::span<const std::array<double, 2>> nodes,
                                            const Execution& execution) {
    return on_triangulation(points, nodes, nullptr, execution, "linear interpolation", linear).z;
}

std::vector<double> natural_neighbors(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes,
                                      const Execution& execution) {
    return on_triangulation(points, nodes, nullptr, execution, "natural neighbors", natural).z;
}

PartValues linear_on_part(std::span<const std::array<double, 3>> points,
                          std::span<const std::array<double, 2>> nodes, const PointsAround& around,
                          const Execution& execution) {
    return on_triangulation(points, nodes, &around, execution, "linear interpolation", linear);
}

PartValues natural_neighbors_of_part(std::span<const std::array<double, 3>> points,
                                     std::span<const std::array<double, 2>> nodes,
                                     const PointsAround& around, const Execution& execution) {
    return on_triangulation(points, nodes, &around, execution, "natural neighbors", natural);
}

}  // namespace realmodel::interpolation
