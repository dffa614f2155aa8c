// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/triangulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "meshing/constrained_delaunay.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/convex_hull.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

namespace {

constexpr double kSlack = 1e-6;  // of the size of a circle, for rounding
constexpr double kFlat = 1e-7;   // of the squared side: of flatter triangles circles are rounding
constexpr double kOfOrigin = 4e-16;  // what coordinates relative to the origin may be off by

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

/// Tells of circles whether a subset of some points has all points that may lie in them. Positions
/// are local coordinates.
class SubsetCheck {
public:
    SubsetCheck(const DataPoints& data, const PointsAround& around);

    /// Whether a node lies in the hull of all points, its border included. Exact.
    bool in_hull(const PlanPosition& node) const { return hull_.contains(node); }
    const HullBorder& border() const { return border_; }
    /// Whether the subset is the whole.
    bool is_whole() const { return is_whole_; }

    /// Whether two points are next to each other on the border of the hull.
    bool is_hull_edge(const PlanPosition& a, const PlanPosition& b) const;

    /// Whether the subset has all points in the circle through p and two points, or, of an edge of
    /// the hull, on the side of the edge where p is.
    bool has_all_in_circle(const PlanPosition& p, const PlanPosition& a,
                           const PlanPosition& b) const;

private:
    bool has_all_in(const spatial::PlanBox& box) const;

    ConvexHull hull_;
    HullBorder border_;
    std::vector<std::pair<PlanPosition, std::size_t>> place_on_border_;  // ascending
    spatial::PlanBox all_, window_;
    bool is_whole_;
};

std::vector<PlanPosition> local_positions(const DataPoints& data,
                                          std::span<const std::array<double, 3>> points) {
    return transformed(points, [&](const auto& p) { return data.to_local({p[0], p[1]}); });
}

SubsetCheck::SubsetCheck(const DataPoints& data, const PointsAround& around)
    : hull_(local_positions(data, around.border)), is_whole_(around.is_whole) {
    const std::vector<PlanPosition> places = local_positions(data, around.border);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t next = (i + 1) % places.size();
        border_.add(places[i], around.border[i][2], places[next], around.border[next][2]);
        place_on_border_.emplace_back(places[i], i);
    }
    std::sort(place_on_border_.begin(), place_on_border_.end());
    const double x = data.origin[0], y = data.origin[1];
    const double off = kOfOrigin * std::max(std::abs(x), std::abs(y));
    const auto local_box = [&](const std::array<double, 4>& box) {
        return spatial::PlanBox{box[0] - x, box[1] - y, box[2] - x, box[3] - y};
    };
    all_ = local_box(around.all).widened(2 * off);
    window_ = local_box(around.window).widened(-2 * off);
}

bool SubsetCheck::is_hull_edge(const PlanPosition& a, const PlanPosition& b) const {
    const auto place = [&](const PlanPosition& p) {
        const auto entry = std::lower_bound(place_on_border_.begin(), place_on_border_.end(),
                                            std::pair(p, std::size_t{0}));
        const bool is_on_border = entry != place_on_border_.end() && entry->first == p;
        return is_on_border ? entry->second : place_on_border_.size();
    };
    const std::size_t count = place_on_border_.size(), i = place(a), j = place(b);
    if (i == count || j == count) return false;
    return (i + 1) % count == j || (j + 1) % count == i;
}

bool SubsetCheck::has_all_in(const spatial::PlanBox& box) const {
    return std::max(box.low_x, all_.low_x) >= window_.low_x &&
           std::max(box.low_y, all_.low_y) >= window_.low_y &&
           std::min(box.high_x, all_.high_x) <= window_.high_x &&
           std::min(box.high_y, all_.high_y) <= window_.high_y;
}

bool SubsetCheck::has_all_in_circle(const PlanPosition& p, const PlanPosition& a,
                                    const PlanPosition& b) const {
    if (is_whole_) return true;
    const double ax = a[0] - p[0], ay = a[1] - p[1], bx = b[0] - p[0], by = b[1] - p[1];
    const double cross = ax * by - ay * bx, dot = ax * bx + ay * by;
    const double aa = ax * ax + ay * ay, bb = bx * bx + by * by;
    const double ux = bx - ax, uy = by - ay, edge_length = std::sqrt(ux * ux + uy * uy);
    if (dot <= 0 && is_hull_edge(a, b)) {
        // Less than half a circle: it reaches from the edge as high as the tangent of half the arc
        // tells, and is nowhere wider.
        const double high =
            0.5 * std::abs(cross) / (std::sqrt(aa) * std::sqrt(bb) - dot) * (1 + kSlack);
        const double off_x = std::abs(uy) * high, off_y = std::abs(ux) * high;
        const spatial::PlanBox box{std::min(a[0], b[0]) - off_x, std::min(a[1], b[1]) - off_y,
                                   std::max(a[0], b[0]) + off_x, std::max(a[1], b[1]) + off_y};
        return has_all_in(box.widened(kSlack * edge_length));
    }
    if (!(std::abs(cross) > kFlat * std::max({aa, bb, edge_length * edge_length}))) return false;
    const double x = (by * aa - ay * bb) / (2 * cross), y = (ax * bb - bx * aa) / (2 * cross);
    const double radius = std::sqrt(x * x + y * y) * (1 + kSlack);
    const double middle_x = p[0] + x, middle_y = p[1] + y;
    // What of the circle is in the box of all points.
    const auto beyond = [](double at, double low, double high) {
        return std::max({low - at, at - high, 0.0});
    };
    const auto half = [&](double off) {
        return std::sqrt(std::max(radius * radius - off * off, 0.0));
    };
    const double half_x = half(beyond(middle_y, all_.low_y, all_.high_y)) + kSlack * radius;
    const double half_y = half(beyond(middle_x, all_.low_x, all_.high_x)) + kSlack * radius;
    return has_all_in({middle_x - half_x, middle_y - half_y, middle_x + half_x, middle_y + half_y});
}

using FaceHandle = PointTriangulation::FaceHandle;
using Delaunay = PointTriangulation::Delaunay;
using DelaunayEdge = Delaunay::Edge;
using meshing::Kernel;
using KernelPoint = Kernel::Point_2;

// Of the distances to the neighbors: where their weighted mean misses the node by more, the areas
// are rounding.
constexpr double kAreasAgree = 1e-7;

/// What a value follows from. check: whether a subset of the points suffices; null where there are
/// all.
struct ValueSource {
    const DataPoints& data;
    const PointTriangulation& triangulation;
    const SubsetCheck* check;

    const Delaunay& delaunay() const { return triangulation.delaunay(); }
    std::int32_t number(const DelaunayEdge& edge, int turned) const {
        return edge.first->vertex((edge.second + turned) % 3)->number;
    }
    bool circle_suffices(const PlanPosition& p, std::int32_t a, std::int32_t b) const {
        return check == nullptr || check->has_all_in_circle(p, data.local[a], data.local[b]);
    }
    bool triangle_suffices(FaceHandle face) const {
        const auto [a, b, c] = triangulation.corners(face);
        return circle_suffices(data.local[a], b, c) || circle_suffices(data.local[b], c, a) ||
               circle_suffices(data.local[c], a, b);
    }
};

/// Where a node is. face: a finite triangle; on an edge between two, the one whose other corner has
/// the lower number: it does not matter then in which order points were inserted. from, to: the
/// numbers of the ends of the edge, ascending.
struct NodeLocation {
    FaceHandle face, other;  ///< other: of an edge
    bool is_on_edge = false, is_on_hull = false;
    std::int32_t from = 0, to = 0;
};

NodeLocation place_of(const Delaunay& delaunay, Delaunay::Locate_type kind, FaceHandle face,
                      int at) {
    NodeLocation place;
    place.face = face;
    if (kind == Delaunay::FACE) return place;
    place.is_on_edge = true;
    place.other = face->neighbor(at);
    const auto number = [](FaceHandle f, int i) { return f->vertex(i)->number; };
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
bool suffices(const ValueSource& source, const NodeLocation& place) {
    if (source.check == nullptr || source.check->is_whole()) return true;
    if (place.is_on_hull)
        return source.check->is_hull_edge(source.data.local[place.from],
                                          source.data.local[place.to]) &&
               source.triangle_suffices(place.face);
    return source.triangle_suffices(place.face) &&
           (!place.is_on_edge || source.triangle_suffices(place.other));
}

/// A value, and whether the points suffice for it.
struct SubsetValue {
    double value;
    bool is_certain;
};

SubsetValue linear(const ValueSource& source, const PlanPosition& node, const NodeLocation& place) {
    return {source.triangulation.linear(node, place.face), suffices(source, place)};
}

/// value(source, node, place) for each node in a triangle; the border's value elsewhere. around:
/// null where there are all points.
template <class Value>
SubsetValues on_triangulation(std::span<const std::array<double, 3>> points,
                              std::span<const PlanPosition> nodes, const PointsAround* around,
                              const Execution& execution, const char* text, Value&& value) {
    require_finite_nodes(nodes);
    const DataPoints data = prepare_points(points);
    const PointTriangulation triangulation(data, execution.progress);
    std::optional<SubsetCheck> check;
    if (around != nullptr) check.emplace(data, *around);
    const ValueSource source{data, triangulation, check ? &*check : nullptr};
    SubsetValues out{std::vector<double>(nodes.size()), std::vector<std::uint8_t>(nodes.size(), 1)};
    const NodeLoop loop{nodes.size(), 256, execution, text};
    loop.over_nodes(
        [] { return std::vector<spatial::Neighbor>(); },
        [&](std::vector<spatial::Neighbor>& nearest, std::size_t i) {
            const PlanPosition node = data.to_local(nodes[i]);
            if (check && !check->in_hull(node)) {
                out.z[i] = check->border().nearest_value(node);
                return;
            }
            Delaunay::Locate_type kind = Delaunay::OUTSIDE_AFFINE_HULL;
            int at = 0;
            FaceHandle face = triangulation.near(node, nearest);
            if (face != FaceHandle()) {
                face = triangulation.delaunay().locate({node[0], node[1]}, kind, at, face);
            }
            if (kind == Delaunay::VERTEX) {
                out.z[i] = data.values[face->vertex(at)->number];
            } else if (kind == Delaunay::FACE || kind == Delaunay::EDGE) {
                const NodeLocation place = place_of(triangulation.delaunay(), kind, face, at);
                const SubsetValue here = value(source, node, place);
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
SubsetValue natural(const ValueSource& source, const PlanPosition& node,
                    const NodeLocation& place) {
    thread_local PointWeights weights;
    thread_local std::vector<DelaunayEdge> hole;
    weights.clear();
    bool is_certain = true;
    if (place.is_on_hull) {
        add_weights_on_hull(source, node, place, weights);
        is_certain = suffices(source, place);
    } else {
        hole.clear();
        const KernelPoint point(node[0], node[1]);
        source.delaunay().get_boundary_of_conflicts(point, std::back_inserter(hole), place.face);
        for (const DelaunayEdge& edge : hole) {
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
        const SubsetValue plain = linear(source, node, place);
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

SubsetValues linear_on_subset(std::span<const std::array<double, 3>> points,
                              std::span<const std::array<double, 2>> nodes,
                              const PointsAround& around, const Execution& execution) {
    return on_triangulation(points, nodes, &around, execution, "linear interpolation", linear);
}

SubsetValues natural_neighbors_of_subset(std::span<const std::array<double, 3>> points,
                                         std::span<const std::array<double, 2>> nodes,
                                         const PointsAround& around, const Execution& execution) {
    return on_triangulation(points, nodes, &around, execution, "natural neighbors", natural);
}

}  // namespace realmodel::interpolation
