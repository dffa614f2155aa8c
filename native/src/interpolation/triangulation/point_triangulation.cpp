// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/triangulation/point_triangulation.hpp"

#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/vectors.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::interpolation {

PointTriangulation::PointTriangulation(const DataPoints& data, Progress* progress)
    : data_(data), tree_(data.local), vertices_(data.local.size()) {
    std::vector<Kernel::Point_2> points;
    for (const auto& [x, y] : data.local)
        points.emplace_back(x, y);
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    using PointOf = CGAL::Pointer_property_map<Kernel::Point_2>::const_type;
    CGAL::spatial_sort(order.begin(), order.end(),
                       CGAL::Spatial_sort_traits_adapter_2<Kernel, PointOf>(points.data()));
    Face last;
    std::size_t inserted = 0;
    for (const std::size_t point : order) {
        if (++inserted % 1024 == 0 && progress != nullptr) progress->check();
        const Delaunay::Vertex_handle vertex = delaunay_.insert(points[point], last);
        vertex->info() = static_cast<std::int32_t>(point);
        vertices_[point] = vertex;
        last = vertex->face();
    }
    if (delaunay_.dimension() == 2) {
        auto face = delaunay_.incident_faces(delaunay_.infinite_vertex());
        const auto first = face;
        do {
            const int i = face->index(delaunay_.infinite_vertex());
            add_border(face->vertex(Delaunay::cw(i))->info(),
                       face->vertex(Delaunay::ccw(i))->info());
        } while (++face != first);
    } else if (delaunay_.dimension() == 1) {
        for (auto edge = delaunay_.finite_edges_begin(); edge != delaunay_.finite_edges_end();
             ++edge) {
            add_border(edge->first->vertex(0)->info(), edge->first->vertex(1)->info());
        }
    } else {
        const std::int32_t only = delaunay_.finite_vertices_begin()->info();
        add_border(only, only);
    }
}

PointTriangulation::Face PointTriangulation::near(const Position& position,
                                                  std::vector<spatial::Neighbor>& found) const {
    if (delaunay_.dimension() < 2) return {};
    tree_.find(position, 1, found);
    return vertices_[found[0].point]->face();
}

std::array<std::int32_t, 3> PointTriangulation::corners(Face face) const {
    std::array<std::int32_t, 3> out{};
    for (int k = 0; k < 3; ++k)
        out[k] = face->vertex(k)->info();
    std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
    return out;
}

double PointTriangulation::linear(const Position& position, Face face) const {
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

double HullBorder::nearest_value(const Position& position) const {
    double least = std::numeric_limits<double>::infinity(), value = 0;
    const Edge* nearest = nullptr;
    for (const Edge& edge : edges_) {
        const Position& from = edge.from;
        const double t = nearest_share(from, edge.to, position);
        const Position off = moved(minus(position, from), -t, minus(edge.to, from));
        const double squared = dot(off, off);
        const bool is_first = squared == least && nearest != nullptr && from < nearest->from;
        if (!(squared < least) && !is_first) continue;
        least = squared;
        nearest = &edge;
        value = t == 1 ? edge.to_value : edge.from_value + t * (edge.to_value - edge.from_value);
    }
    return value;
}

}  // namespace realmodel::interpolation
