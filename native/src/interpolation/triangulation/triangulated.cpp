// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "meshing/constrained_delaunay.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/progress.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

/// The border of the hull of data points.
class HullBorder {
public:
    /// Edges counterclockwise, in any order.
    void add(const PlanPosition& from, double from_value, const PlanPosition& to, double to_value) {
        edges_.push_back({from, to, from_value, to_value});
    }
    /// Value at the nearest place of the border; of places equally near that of the edge that
    /// begins at the lexicographically least position.
    double nearest_value(const PlanPosition& position) const;

private:
    struct ValuedEdge {
        PlanPosition from, to;
        double from_value, to_value;
    };
    std::vector<ValuedEdge> edges_;
};

/// The Delaunay triangulation of data points, in local coordinates; its vertices have the numbers
/// of their points. Several threads may ask at once.
class PointTriangulation {
public:
    using Delaunay = meshing::Cdt;
    using FaceHandle = Delaunay::Face_handle;

    PointTriangulation(const DataPoints& data, Progress* progress);

    const Delaunay& delaunay() const { return delaunay_; }

    /// A triangle at the point nearest to a position: where the search for it begins, so that what
    /// is found on ties depends on the position alone. No triangle where the points lie in one
    /// line.
    FaceHandle near(const PlanPosition& position, std::vector<spatial::Neighbor>& nearest) const;

    /// The corners of a triangle counterclockwise from the one with the least number: it does not
    /// matter then in which order points were inserted.
    std::array<std::int32_t, 3> corners(FaceHandle face) const;

    /// Value at a position inside `face`, linear between its corners.
    double linear(const PlanPosition& position, FaceHandle face) const;

    const HullBorder& border() const { return border_; }

private:
    void add_border(std::int32_t a, std::int32_t b) {
        border_.add(data_.local[a], data_.values[a], data_.local[b], data_.values[b]);
    }

    const DataPoints& data_;
    spatial::NearestPoints tree_;
    Delaunay delaunay_;
    std::vector<Delaunay::Vertex_handle> vertices_;  // by point
    HullBorder border_;                              // of points in one line all edges
};

PointTriangulation::PointTriangulation(const DataPoints& data, Progress* progress)
    : data_(data),
      tree_(data.local),
      vertices_(meshing::insert_points(delaunay_, data.local, meshing::stopped_by(progress),
                                       meshing::Repeated::kJoin)) {
    if (delaunay_.dimension() == 2) {
        auto face = delaunay_.incident_faces(delaunay_.infinite_vertex());
        const auto first = face;
        do {
            const int i = face->index(delaunay_.infinite_vertex());
            add_border(face->vertex(Delaunay::cw(i))->number,
                       face->vertex(Delaunay::ccw(i))->number);
        } while (++face != first);
    } else if (delaunay_.dimension() == 1) {
        for (auto edge = delaunay_.finite_edges_begin(); edge != delaunay_.finite_edges_end();
             ++edge) {
            add_border(edge->first->vertex(0)->number, edge->first->vertex(1)->number);
        }
    } else {
        const std::int32_t only = delaunay_.finite_vertices_begin()->number;
        add_border(only, only);
    }
}

PointTriangulation::FaceHandle PointTriangulation::near(
    const PlanPosition& position, std::vector<spatial::Neighbor>& nearest) const {
    if (delaunay_.dimension() < 2) return {};
    tree_.find(position, 1, nearest);
    return vertices_[nearest[0].point]->face();
}

std::array<std::int32_t, 3> PointTriangulation::corners(FaceHandle face) const {
    std::array<std::int32_t, 3> out{};
    for (int k = 0; k < 3; ++k)
        out[k] = face->vertex(k)->number;
    std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
    return out;
}

double PointTriangulation::linear(const PlanPosition& position, FaceHandle face) const {
    std::array<double, 3> x{}, y{}, z{};
    const std::array<std::int32_t, 3> points = corners(face);
    for (int k = 0; k < 3; ++k) {
        const auto point = points[k];
        x[k] = data_.local[point][0] - position[0];
        y[k] = data_.local[point][1] - position[1];
        z[k] = data_.values[point];
        if (x[k] == 0 && y[k] == 0) return z[k];
    }
    const double a = x[1] * y[2] - x[2] * y[1], b = x[2] * y[0] - x[0] * y[2],
                 c = x[0] * y[1] - x[1] * y[0];
    const double area = a + b + c;
    // A triangle so thin that its area is lost to rounding: its nearest corner will do.
    if (!(area > 0)) {
        std::size_t nearest = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (elementary::hypot(x[k], y[k]) < elementary::hypot(x[nearest], y[nearest]))
                nearest = k;
        }
        return z[nearest];
    }
    const double wb = std::clamp(b / area, 0.0, 1.0), wc = std::clamp(c / area, 0.0, 1.0);
    return z[0] + wb * (z[1] - z[0]) + wc * (z[2] - z[0]);
}

double HullBorder::nearest_value(const PlanPosition& position) const {
    double least = std::numeric_limits<double>::infinity(), value = 0;
    const ValuedEdge* nearest = nullptr;
    for (const ValuedEdge& edge : edges_) {
        const PlanPosition& from = edge.from;
        const double t = nearest_share(from, edge.to, position);
        const PlanPosition off = moved(minus(position, from), -t, minus(edge.to, from));
        const double squared = dot(off, off);
        const bool is_first = squared == least && nearest != nullptr && from < nearest->from;
        if (!(squared < least) && !is_first) continue;
        least = squared;
        nearest = &edge;
        value = t == 1 ? edge.to_value : edge.from_value + t * (edge.to_value - edge.from_value);
    }
    return value;
}

using FaceHandle = PointTriangulation::FaceHandle;
using Delaunay = PointTriangulation::Delaunay;
using DelaunayEdge = Delaunay::Edge;
using meshing::Kernel;
using KernelPoint = Kernel::Point_2;

// Of the distances to the neighbors: where their weighted mean misses the node by more, the areas
// are rounding.
constexpr double kAreasAgree = 1e-7;

/// What a value follows from.
struct ValueSource {
    const DataPoints& data;
    const PointTriangulation& triangulation;

    const Delaunay& delaunay() const { return triangulation.delaunay(); }
    std::int32_t number(const DelaunayEdge& edge, int turned) const {
        return edge.first->vertex((edge.second + turned) % 3)->number;
    }
};

/// Where a node is. face: a finite triangle; on an edge between two, the one whose other corner has
/// the lower number: it does not matter then in which order points were inserted. from, to: the
/// numbers of the ends of the edge, ascending.
struct NodeLocation {
    FaceHandle face;
    bool is_on_hull = false;
    std::int32_t from = 0, to = 0;
};

NodeLocation place_of(const Delaunay& delaunay, Delaunay::Locate_type kind, FaceHandle face,
                      int at) {
    NodeLocation place;
    place.face = face;
    if (kind == Delaunay::FACE) return place;
    const FaceHandle other = face->neighbor(at);
    const auto number = [](FaceHandle f, int i) { return f->vertex(i)->number; };
    place.from = std::min(number(face, Delaunay::cw(at)), number(face, Delaunay::ccw(at)));
    place.to = std::max(number(face, Delaunay::cw(at)), number(face, Delaunay::ccw(at)));
    place.is_on_hull = delaunay.is_infinite(face) || delaunay.is_infinite(other);
    const bool other_first = place.is_on_hull
                                 ? delaunay.is_infinite(face)
                                 : number(other, other->index(face)) < number(face, at);
    if (other_first) place.face = other;
    return place;
}

double linear(const ValueSource& source, const PlanPosition& node, const NodeLocation& place) {
    return source.triangulation.linear(node, place.face);
}

/// value(source, node, place) for each node in a triangle; the border's value elsewhere.
template <class Value>
std::vector<double> on_triangulation(std::span<const std::array<double, 3>> points,
                                     std::span<const PlanPosition> nodes,
                                     const Execution& execution, const char* text, Value&& value) {
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    const PointTriangulation triangulation(data, execution.progress);
    const ValueSource source{data, triangulation};
    std::vector<double> z(nodes.size());
    const NodeLoop loop{nodes.size(), 256, execution, text};
    loop.over_nodes(
        [] { return std::vector<spatial::Neighbor>(); },
        [&](std::vector<spatial::Neighbor>& nearest, std::size_t i) {
            const PlanPosition node = data.to_local(nodes[i]);
            Delaunay::Locate_type kind = Delaunay::OUTSIDE_AFFINE_HULL;
            int at = 0;
            FaceHandle face = triangulation.near(node, nearest);
            if (face != FaceHandle()) {
                face = triangulation.delaunay().locate({node[0], node[1]}, kind, at, face);
            }
            if (kind == Delaunay::VERTEX) {
                z[i] = data.values[face->vertex(at)->number];
            } else if (kind == Delaunay::FACE || kind == Delaunay::EDGE) {
                z[i] = value(source, node, place_of(triangulation.delaunay(), kind, face, at));
            } else {
                z[i] = triangulation.border().nearest_value(node);
            }
        });
    return z;
}

/// Whether a circle through a node and both ends of an edge has its center nowhere, for doubles.
bool has_no_center(const KernelPoint& node, const DelaunayEdge& edge) {
    const auto corner = [&](int turned) {
        return edge.first->vertex((edge.second + turned) % 3)->point();
    };
    const auto is_flat = [&](const KernelPoint& p, const KernelPoint& q) {
        return (q.x() - p.x()) * (node.y() - p.y()) == (q.y() - p.y()) * (node.x() - p.x());
    };
    return is_flat(corner(1), corner(2)) || is_flat(corner(2), corner(1));
}

using PointWeights = std::vector<std::pair<std::int32_t, double>>;  // by number of the point

/// On an edge of the hull only its ends count.
void add_weights_on_hull(const ValueSource& source, const PlanPosition& node,
                         const NodeLocation& place, PointWeights& weights) {
    const PlanPosition &from = source.data.local[place.from], &to = source.data.local[place.to];
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
bool add_weights(const ValueSource& source, const KernelPoint& node,
                 std::vector<DelaunayEdge>& hole, PointWeights& weights) {
    if (std::ranges::any_of(hole,
                            [&](const DelaunayEdge& edge) { return has_no_center(node, edge); }))
        return false;
    const auto end_of = [&](const DelaunayEdge& edge) { return source.number(edge, 2); };
    std::rotate(hole.begin(),
                std::min_element(hole.begin(), hole.end(),
                                 [&](const DelaunayEdge& a, const DelaunayEdge& b) {
                                     return end_of(a) < end_of(b);
                                 }),
                hole.end());
    const Kernel kernel;
    const auto center = kernel.construct_circumcenter_2_object();
    const auto area_of = kernel.compute_area_2_object();
    const auto at = [&](std::int32_t number) {
        const PlanPosition& local = source.data.local[number];
        return KernelPoint(local[0], local[1]);
    };
    const auto center_of = [&](FaceHandle face) {
        const auto [a, b, c] = source.triangulation.corners(face);
        return center(at(a), at(b), at(c));
    };
    Delaunay::Vertex_handle before = hole.back().first->vertex(Delaunay::cw(hole.back().second));
    for (const DelaunayEdge& edge : hole) {
        const Delaunay::Vertex_handle current = edge.first->vertex(Delaunay::cw(edge.second));
        const KernelPoint first =
            center(current->point(), edge.first->vertex(Delaunay::ccw(edge.second))->point(), node);
        auto face = source.delaunay().incident_faces(current, edge.first);
        ++face;
        KernelPoint last = center_of(face);
        double area = 0;
        while (!face->has_vertex(before)) {
            ++face;
            const KernelPoint next = center_of(face);
            area += area_of(first, last, next);
            last = next;
        }
        area += area_of(first, last, center(before->point(), current->point(), node));
        if (area > 0) weights.emplace_back(current->number, area);
        before = current;
    }
    return true;
}

/// Sibson's coordinates, checked: their weighted mean must give the node back.
double natural(const ValueSource& source, const PlanPosition& node, const NodeLocation& place) {
    thread_local PointWeights weights;
    thread_local std::vector<DelaunayEdge> hole;
    weights.clear();
    if (place.is_on_hull) {
        add_weights_on_hull(source, node, place, weights);
    } else {
        hole.clear();
        const KernelPoint point(node[0], node[1]);
        source.delaunay().get_boundary_of_conflicts(point, std::back_inserter(hole), place.face);
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
        return linear(source, node, place);
    }
    return base + z / sum;
}

}  // namespace

std::vector<double> linear_on_triangulation(std::span<const std::array<double, 3>> points,
                                            std::span<const std::array<double, 2>> nodes,
                                            const Execution& execution) {
    return on_triangulation(points, nodes, execution, "linear interpolation", linear);
}

std::vector<double> natural_neighbors(std::span<const std::array<double, 3>> points,
                                      std::span<const std::array<double, 2>> nodes,
                                      const Execution& execution) {
    return on_triangulation(points, nodes, execution, "natural neighbors", natural);
}

}  // namespace realmodel::interpolation
