// SPDX-License-Identifier: GPL-3.0-or-later
// outside_hull, tin, natural_neighbour, surface_heights, surface_places, dsi, ties, tied_heights,
// raised_heights, crowded_data.
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
#include "realmodel/interpolation/ties.hpp"
#include "realmodel/interpolation/triangulated.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

NumpyArray<bool> outside_hull(const NumpyArray<double>& points, const NumpyArray<double>& nodes,
                              WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    auto outside = unlocked([&] { return interpolation::outside_hull(from, to, run(execution)); });
    return to_array(std::move(outside)).attr("view")("bool");
}

template <auto method>
NumpyArray<double> on_triangulation(const NumpyArray<double>& points,
                                    const NumpyArray<double>& nodes, WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    return to_array(unlocked([&] { return method(from, to, run(execution)); }));
}

NumpyArray<double> surface_heights(const NumpyArray<double>& vertices,
                                   const NumpyArray<std::int32_t>& triangles,
                                   const NumpyArray<double>& nodes, WatchedExecution* execution) {
    const auto corners = rows<3>(vertices, "vertices");
    const auto faces = rows<3>(triangles, "triangles");
    const auto to = rows<2>(nodes, "nodes");
    return to_array(unlocked(
        [&] { return interpolation::heights_on_surface(corners, faces, to, run(execution)); }));
}

std::pair<NumpyArray<std::int32_t>, NumpyArray<double>> surface_places(
    const NumpyArray<double>& vertices, const NumpyArray<std::int32_t>& triangles,
    const NumpyArray<double>& nodes, WatchedExecution* execution) {
    const auto corners = rows<3>(vertices, "vertices");
    const auto faces = rows<3>(triangles, "triangles");
    const auto to = rows<2>(nodes, "nodes");
    auto result = unlocked(
        [&] { return interpolation::places_on_surface(corners, faces, to, run(execution)); });
    return {to_array(std::move(result.triangle)), to_array(std::move(result.weights))};
}

/// Of each node, or empty: the height that it has, the least and the most.
using BoundArrays = std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>;
/// Positions, slopes.
using SlopeArrays = std::pair<NumpyArray<double>, NumpyArray<double>>;
/// Points at or above which, and at or below which heights are.
using PointBounds = std::pair<NumpyArray<double>, NumpyArray<double>>;

py::dict dsi(const NumpyArray<double>& points, const NumpyArray<double>& nodes,
             const NumpyArray<std::int32_t>& triangles, const BoundArrays& bounds, double weight,
             const std::optional<SlopeArrays>& dips, const std::optional<PointBounds>& point_bounds,
             WatchedExecution* execution) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    const auto faces = rows<3>(triangles, "triangles");
    const auto& [equal, least, most] = bounds;
    interpolation::DsiConstraints constraints{view(equal), view(least), view(most)};
    if (dips) {
        constraints.dips = {rows<2>(dips->first, "positions of dips"),
                            rows<2>(dips->second, "slopes"), 1, 0};
    }
    if (point_bounds) {
        constraints.lower = rows<3>(point_bounds->first, "lower bounds");
        constraints.upper = rows<3>(point_bounds->second, "upper bounds");
    }
    auto result = unlocked(
        [&] { return interpolation::dsi(from, to, faces, constraints, weight, run(execution)); });
    py::dict out;
    out["z"] = to_array(std::move(result.z));
    out["outside"] = result.outside;
    out["missed"] = result.missed;
    out["misfit"] = result.misfit;
    out["dips_outside"] = result.dips_outside;
    out["dips_missed"] = result.dips_missed;
    out["bounds_missed"] = result.bounds_missed;
    out["iterations"] = result.iterations;
    out["converged"] = result.converged;
    return out;
}

/// Heights (S, N), sides (S, F), weights (F, N).
using SheetArrays = std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>;
/// Places (C, 2), lower and upper bounds (C,), sheets (C,).
using TieArrays = std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>,
                             NumpyArray<std::int32_t>>;
/// Places (C, 2), lower and upper bounds (C,), margins (C,).
using RaisedArrays =
    std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>;
/// Radii (L,), positions (M, 2), sided (M, F), coefficients (L, M).
using TermArrays =
    std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>;

py::dict ties(const NumpyArray<double>& nodes, const NumpyArray<std::int32_t>& triangles,
              const SheetArrays& sheets, const TieArrays& data, double tolerance,
              WatchedExecution* execution) {
    const auto& [heights, sides, weights] = sheets;
    const auto& [places, lower, upper, numbers] = data;
    const interpolation::TiedSheets input{rows<2>(nodes, "nodes"), rows<3>(triangles, "triangles"),
                                          view(heights), view(sides), view(weights)};
    const interpolation::TieData asked{rows<2>(places, "places"), view(lower), view(upper),
                                       view(numbers)};
    auto result =
        unlocked([&] { return interpolation::tie(input, asked, tolerance, run(execution)); });
    py::dict out;
    out["radii"] = to_array(std::move(result.terms.radii));
    out["positions"] = to_array(std::move(result.terms.positions));
    out["sided"] = to_array(std::move(result.terms.sided));
    out["coefficients"] = to_array(std::move(result.terms.coefficients));
    out["before"] = to_array(std::move(result.before));
    out["after"] = to_array(std::move(result.after));
    return out;
}

NumpyArray<double> tied_heights(const NumpyArray<double>& heights, const NumpyArray<double>& nodes,
                                const NumpyArray<double>& sided, const TermArrays& terms,
                                WatchedExecution* execution) {
    const auto& [radii, positions, of_centers, coefficients] = terms;
    const auto centers = rows<2>(positions, "positions");
    const auto to = rows<2>(nodes, "nodes");
    const auto copy = [](const NumpyArray<double>& array) {
        return std::vector<double>(array.data(), array.data() + array.size());
    };
    const interpolation::TieTerms input{
        copy(radii), {centers.begin(), centers.end()}, copy(of_centers), copy(coefficients)};
    return to_array(unlocked([&] {
        return interpolation::tied_heights(view(heights), to, view(sided), input, run(execution));
    }));
}

NumpyArray<double> raised_heights(const NumpyArray<double>& nodes,
                                  const NumpyArray<std::int32_t>& triangles,
                                  const std::pair<NumpyArray<double>, NumpyArray<double>>& heights,
                                  const RaisedArrays& data, double tolerance,
                                  WatchedExecution* execution) {
    const auto& [z, least] = heights;
    const auto& [places, lower, upper, margins] = data;
    const interpolation::RaisedSheet sheet{rows<2>(nodes, "nodes"), rows<3>(triangles, "triangles"),
                                           view(z), view(least)};
    const interpolation::TieData asked{rows<2>(places, "places"), view(lower), view(upper), {}};
    const auto narrowed_by = view(margins);
    return to_array(unlocked([&] {
        return interpolation::raised_heights(sheet, asked, narrowed_by, tolerance, run(execution));
    }));
}

std::pair<NumpyArray<std::int32_t>, NumpyArray<double>> crowded_data(
    const NumpyArray<double>& nodes, const NumpyArray<std::int32_t>& triangles,
    const std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>& data,
    double least) {
    const auto& [places, lower, upper] = data;
    const std::vector<double> zeros(static_cast<std::size_t>(nodes.shape(0)), 0.0);
    const interpolation::TiedSheets sheet{
        rows<2>(nodes, "nodes"), rows<3>(triangles, "triangles"), zeros, {}, {}};
    const std::vector<std::int32_t> one(static_cast<std::size_t>(places.shape(0)), 0);
    const interpolation::TieData asked{rows<2>(places, "places"), view(lower), view(upper), one};
    auto result = unlocked([&] { return interpolation::crowded_data(sheet, asked, least); });
    return {to_array(std::move(result.numbers)), to_array(std::move(result.room))};
}

void bind_ties(py::module_& module) {
    using py::arg;
    module.def(
        "ties", &ties, arg("nodes"), arg("triangles"), arg("sheets"), arg("data"), arg("tolerance"),
        arg("execution") = py::none(),
        R"(A correction of sheets over a planar mesh, nodes (N, 2), triangles (T, 3), to honor data.

sheets     heights (S, N), NaN where there are none; sides (S, F) of faults, -1, +1, or 0 for both;
           weights (F, N): where 0, both sides of a fault are corrected alike, where 1 by themselves
data       places (C, 2); lower and upper bounds (C,), equal for contacts; the sheet of each (C,)
tolerance  heights so near to what is asked for are right

Returns a dict: radii (L,), positions (M, 2), sided (M F,), coefficients (L M,), for tied_heights; before
and after, (C,): how far the sheet lies below each datum, above it negative, NaN where it has no triangle.
Raises InputError: kind "not_finite", "bad_index"; Cancelled.)");
    module.def("tied_heights", &tied_heights, arg("heights"), arg("nodes"), arg("sided"),
               arg("terms"), arg("execution") = py::none(),
               R"(Heights (N,) of a sheet at nodes (N, 2), corrected.

sided  (N, F): the sheet's sides of faults times their weights at the nodes
terms  radii (L,), positions (M, 2), sided (M, F), coefficients (L, M), of ties

Returns (N,). Those of some nodes are the same as among all, to the last bit.)");
    module.def(
        "raised_heights", &raised_heights, arg("nodes"), arg("triangles"), arg("heights"),
        arg("data"), arg("tolerance"), arg("execution") = py::none(),
        R"(The heights of a sheet that was raised at nodes, so that it honors data within triangles, too.

heights    at nodes (N, 2), of triangles (T, 3): as raised (N,), and the least ones (N,), NaN where there is none
data       places (C, 2); lower and upper bounds (C,); margins (C,), by how much these are narrowed
tolerance  heights so near to what is asked for are right

Returns (N,). Raises InputError: kind "not_finite", "bad_index"; Cancelled.)");
    module.def("crowded_data", &crowded_data, arg("nodes"), arg("triangles"), arg("data"),
               arg("least"),
               R"(The data that a mesh, nodes (N, 2), triangles (T, 3), cannot honor beside others.

data  places (C, 2); lower and upper bounds (C,), equal for contacts

Returns their numbers (K,), ascending, and room (K,): how far the nearest of the data that count is.
Raises InputError: kind "not_finite", "bad_index".)");
}

}  // namespace

void bind_surfaces(py::module_& module) {
    using py::arg;
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
        "surface_heights", &surface_heights, arg("vertices"), arg("triangles"), arg("nodes"),
        py::arg("execution") = py::none(),
        R"(Heights of a triangulated surface, vertices (V, 3), triangles (T, 3), at nodes (N, 2).

Returns z (N,), NaN where the surface has none. Raises InputError: kind "not_finite", "bad_index".)");
    module.def("surface_places", &surface_places, arg("vertices"), arg("triangles"), arg("nodes"),
               py::arg("execution") = py::none(),
               R"(Where surface_heights finds the heights; arguments as it has them.

Returns of each node the triangle (N,), -1 where there is none, and weights (N, 2) of its second and third
corner, of what these differ in height from the first one.)");
    module.def(
        "dsi", &dsi, arg("points"), arg("nodes"), arg("triangles"), arg("bounds"),
        arg("weight") = 0.0, arg("dips") = py::none(), arg("point_bounds") = py::none(),
        arg("execution") = py::none(),
        R"(Discrete smooth interpolation of points (P, 3) on a mesh: nodes (N, 2), triangles (T, 3).

bounds  three arrays (N,) of heights that nodes have, are not below, are not above; NaN: none; empty: none
weight  of a point's misfit against the roughness of one node; 0: points hold
dips    (positions (D, 2), slopes (D, 2): dz/dx and dz/dy) of triangles, or None; met as points are
point_bounds  (lower (L, 3), upper (U, 3)): x, y, z at or above which, and at or below which the surface
              is, or None; outside the mesh they say nothing

Returns a dict: z (N,); outside, the number of points in no triangle, which did not count; missed, the
number of points that could not all be met, and misfit, the largest of theirs; dips_outside and
dips_missed, as of points; bounds_missed, the number of point_bounds that are not kept; iterations;
converged, whether they ended because nothing was left to improve.
Raises InputError: kind "no_points", "not_finite", "contradicting_points", "bad_index", "option";
Cancelled.)");
    bind_ties(module);
}

}  // namespace realmodel::bindings
