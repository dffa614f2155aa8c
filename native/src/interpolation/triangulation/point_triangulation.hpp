// SPDX-License-Identifier: GPL-3.0-or-later
// The Delaunay triangulation of data points. Private: CGAL stays behind it.
#pragma once

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <array>
#include <cstdint>
#include <vector>

#include "interpolation/data_points.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// In local coordinates; the vertices know the numbers of their points. Several threads may ask at
/// once.
class PointTriangulation {
public:
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
    using Delaunay =
        CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;
    using Face = Delaunay::Face_handle;

    PointTriangulation(const DataPoints& data, const Progress* progress);

    const Delaunay& delaunay() const { return delaunay_; }

    /// A triangle at the point nearest to a place: where looking for it begins, so that what is
    /// found on ties depends on the place alone. No triangle where the points lie in one line.
    Face near(const Place& place, std::vector<spatial::Neighbour>& found) const;

    /// Value at a place inside `face`, linear between its corners.
    double linear(const Place& place, Face face) const;

    /// Value at the place of the hull's border that is nearest.
    double at_border(const Place& place) const;

private:
    void add_border(std::int32_t a, std::int32_t b) { border_.push_back({a, b}); }

    const DataPoints& data_;
    spatial::NearestPoints tree_;
    Delaunay delaunay_;
    std::vector<Delaunay::Vertex_handle> vertices_;  // by point
    std::vector<std::array<std::int32_t, 2>>
        border_;  // edges of the hull; of points in one line all
};

}  // namespace realmodel::interpolation
