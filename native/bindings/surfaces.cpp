// SPDX-License-Identifier: GPL-3.0-or-later
// hull_corners, hull_border, outside_hull, tin, natural_neighbour, and both of parts of points;
// surface_heights, dsi.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <utility>

#include "execution.hpp"
#include "realmodel/interpolation/convex_hull.hpp"
#include "realmodel/interpolation/dsi.hpp"
#include "realmodel/interpolation/surface_heights.hpp"
#include "realmodel/interpolation/triangulated.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

Array<double> hull_corners(const Array<double>& nodes) {
    const auto given = rows<2>(nodes, "nodes");
    std::vector<std::array<double, 2>> corners;
    {
        const py::gil_scoped_release unlocked;
        corners = interpolation::ConvexHull({given.begin(), given.end()}).corners();
    }
    return to_array(std::move(corners));
}

Array<std::int32_t> hull_border(const Array<double>& nodes) {
    const auto given = rows<2>(nodes, "nodes");
    std::vector<std::int32_t> border;
    {
        const py::gil_scoped_release unlocked;
        border = interpolation::hull_border(given);
    }
    return to_array(std::move(border));
}

Array<bool> outside_hull(const Array<double>& points, const Array<double>& nodes,
                         WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    std::vector<std::uint8_t> outside;
    {
        const py::gil_scoped_release unlocked;
        outside = interpolation::outside_hull(from, to, run(execution));
    }
    return to_array(std::move(outside)).attr("view")("bool");
}

template <auto method>
Array<double> on_triangulation(const Array<double>& points, const Array<double>& nodes,
                               WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    std::vector<double> z;
    {
        const py::gil_scoped_release unlocked;
        z = method(from, to, run(execution));
    }
    return to_array(std::move(z));
}

/// border, all, window, is_whole.
using AroundPart = std::tuple<Array<double>, std::array<double, 4>, std::array<double, 4>, bool>;

template <auto method>
std::tuple<Array<double>, Array<bool>> on_part(const Array<double>& points,
                                               const Array<double>& nodes,
                                               const AroundPart& around_part,
                                               WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    const auto& [border, all, window, is_whole] = around_part;
    const interpolation::PointsAround around{rows<3>(border, "border"), all, window, is_whole};
    interpolation::PartValues found;
    {
        const py::gil_scoped_release unlocked;
        found = method(from, to, around, run(execution));
    }
    return {to_array(std::move(found.z)), to_array(std::move(found.certain)).attr("view")("bool")};
}

Array<double> surface_heights(const Array<double>& vertices, const Array<std::int32_t>& triangles,
                              const Array<double>& nodes, WatchedExecution* execution) {
    const auto corners = rows<3>(vertices, "vertices");
    const auto faces = rows<3>(triangles, "triangles");
    const auto to = rows<2>(nodes, "nodes");
    std::vector<double> z;
    {
        const py::gil_scoped_release unlocked;
        z = interpolation::heights_on_surface(corners, faces, to, run(execution));
    }
    return to_array(std::move(z));
}

/// Of each node, or empty: the height that it has, the least and the most.
using BoundArrays = std::tuple<Array<double>, Array<double>, Array<double>>;
/// Positions, slopes.
using SlopeArrays = std::pair<Array<double>, Array<double>>;

py::dict dsi(const Array<double>& points, const Array<double>& nodes,
             const Array<std::int32_t>& triangles, const BoundArrays& bounds, double weight,
             const std::optional<SlopeArrays>& dips, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    const auto faces = rows<3>(triangles, "triangles");
    const auto heights = [](const Array<double>& array) {
        return std::span<const double>(array.data(), static_cast<std::size_t>(array.size()));
    };
    const auto& [equal, least, most] = bounds;
    interpolation::DsiConstraints constraints{heights(equal), heights(least), heights(most)};
    if (dips) {
        constraints.dips = {rows<2>(dips->first, "positions of dips"),
                            rows<2>(dips->second, "slopes"), 1, 0};
    }
    interpolation::DsiHeights found;
    {
        const py::gil_scoped_release unlocked;
        found = interpolation::dsi(from, to, faces, constraints, weight, run(execution));
    }
    py::dict out;
    out["z"] = to_array(std::move(found.z));
    out["outside"] = found.outside;
    out["missed"] = found.missed;
    out["misfit"] = found.misfit;
    out["dips_outside"] = found.dips_outside;
    out["dips_missed"] = found.dips_missed;
    out["iterations"] = found.iterations;
    out["converged"] = found.converged;
    return out;
}

}  // namespace

void bind_surfaces(py::module_& module) {
    using py::arg;
    module.def("hull_corners", &hull_corners, arg("nodes"),
               R"(The corners (H, 2) of the convex hull of finite nodes (N, 2). Exact.)");
    module.def("hull_border", &hull_border, arg("nodes"),
               R"(The numbers (B,) of nodes (N, 2) on the border of their convex hull, no two equal.

Counterclockwise; of nodes in one line all, from one end. Exact.)");
    module.def("outside_hull", &outside_hull, arg("points"), arg("nodes"),
               py::arg("execution") = py::none(),
               R"(The nodes (N, 2) outside the convex hull of points (P, 3) in plan: (N,) bool.)");
    module.def(
        "tin", &on_triangulation<interpolation::linear_on_triangulation>, arg("points"),
        arg("nodes"), py::arg("execution") = py::none(),
        R"(Linear interpolation on the Delaunay triangulation of points (P, 3) at nodes (N, 2).

Outside the convex hull of the points the value at the nearest place of its border. Returns z (N,).
Raises InputError: kind "no_points", "not_finite", "contradicting_points"; Cancelled.)");
    module.def("natural_neighbour", &on_triangulation<interpolation::natural_neighbors>,
               arg("points"), arg("nodes"), py::arg("execution") = py::none(),
               R"(Natural neighbour interpolation (Sibson); arguments and result as tin.)");
    module.def(
        "tin_of_part", &on_part<interpolation::linear_on_part>, arg("points"), arg("nodes"),
        arg("around"), py::arg("execution") = py::none(),
        R"(tin at nodes (N, 2) from a part of some points, in their order, the first of all before them.

points  (P, 3) float64, no two at one place
around  border (B, 3), those of all points that hull_border gives, for coordinates from the first of
        all; low x, low y, high x, high y of all points; the same of the box of which the part has
        all points; whether these are all points

Returns z (N,), and (N,) bool: where it is that of all points, to the last bit.)");
    module.def("natural_neighbour_of_part", &on_part<interpolation::natural_neighbors_of_part>,
               arg("points"), arg("nodes"), arg("around"), py::arg("execution") = py::none(),
               R"(natural_neighbour at nodes; arguments and result as tin_of_part.)");
    module.def(
        "surface_heights", &surface_heights, arg("vertices"), arg("triangles"), arg("nodes"),
        py::arg("execution") = py::none(),
        R"(Heights of a triangulated surface, vertices (V, 3), triangles (T, 3), at nodes (N, 2).

Returns z (N,), NaN where the surface has none. Raises InputError: kind "not_finite", "bad_index".)");
    module.def(
        "dsi", &dsi, arg("points"), arg("nodes"), arg("triangles"), arg("bounds"),
        arg("weight") = 0.0, arg("dips") = py::none(), arg("execution") = py::none(),
        R"(Discrete smooth interpolation of points (P, 3) on a mesh: nodes (N, 2), triangles (T, 3).

bounds  three arrays (N,) of heights that nodes have, are not below, are not above; NaN: none; empty: none
weight  of a point's misfit against the roughness of one node; 0: points hold
dips    (positions (D, 2), slopes (D, 2): dz/dx and dz/dy) of triangles, or None; met as points are

Returns a dict: z (N,); outside, the number of points in no triangle, which did not count; missed, the
number of points that could not all be met, and misfit, the largest of theirs; dips_outside and
dips_missed, as of points; iterations;
converged, whether they ended because nothing was left to improve.
Raises InputError: kind "no_points", "not_finite", "contradicting_points", "bad_index", "option";
Cancelled.)");
}

}  // namespace realmodel::bindings
