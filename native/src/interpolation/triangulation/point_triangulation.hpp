// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/cgal_kernel.hpp"
// CGAL
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <array>
#include <cstdint>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/base/progress.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// The border of the hull of data points.
class HullBorder {
public:
    /// Edges counterclockwise, in any order.
    void add(const Position& from, double from_value, const Position& to, double to_value) {
        edges_.push_back({from, to, from_value, to_value});
    }
    /// Value at the nearest place of the border; of places equally near that of the edge that
    /// begins at the lexicographically least position.
    double nearest_value(const Position& position) const;

private:
    struct Edge {
        Position from, to;
        double from_value, to_value;
    };
    std::vector<Edge> edges_;
};

/// The Delaunay triangulation of data points, in local coordinates; its vertices have the numbers
/// of their points. Several threads may ask at once.
class PointTriangulation {
public:
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
    using Delaunay =
        CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;
    using Face = Delaunay::Face_handle;

    PointTriangulation(const DataPoints& data, Progress* progress);

    const Delaunay& delaunay() const { return delaunay_; }

    /// A triangle at the point nearest to a position: where the search for it begins, so that what
    /// is found on ties depends on the position alone. No triangle where the points lie in one
    /// line.
    Face near(const Position& position, std::vector<spatial::Neighbor>& found) const;

    /// The corners of a triangle counterclockwise from the one with the least number: it does not
    /// matter then in which order points were inserted.
    std::array<std::int32_t, 3> corners(Face face) const;

    /// Value at a position inside `face`, linear between its corners.
    double linear(const Position& position, Face face) const;

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

}  // namespace realmodel::interpolation
