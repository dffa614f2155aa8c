// SPDX-License-Identifier: GPL-3.0-or-later
// nearest_points, nearest_triangles, heights_at_distance, meeting_boxes, orient2d.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>

#include "execution.hpp"
#include "realmodel/spatial/queries.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

py::tuple nearest_points(const NumpyArray<double>& points, const NumpyArray<double>& positions,
                         std::size_t count, WatchedExecution* execution) {
    const auto from = rows<2>(points, "points");
    const auto to = rows<2>(positions, "positions");
    if (count == 0) throw py::value_error("count: at least 1");
    auto result =
        unlocked([&] { return spatial::nearest_points(from, to, count, run(execution)); });
    return py::make_tuple(to_array(std::move(result.number), count),
                          to_array(std::move(result.distance), count));
}

/// Triangles (T, 3, 3).
std::span<const spatial::SpaceTriangle> space_triangles(const NumpyArray<double>& triangles) {
    if (triangles.ndim() != 3 || triangles.shape(1) != 3 || triangles.shape(2) != 3)
        throw py::value_error("triangles: an array of shape (any, 3, 3) is needed");
    return {reinterpret_cast<const spatial::SpaceTriangle*>(triangles.data()),
            static_cast<std::size_t>(triangles.shape(0))};
}

py::tuple nearest_triangles(const NumpyArray<double>& triangles,
                            const NumpyArray<double>& positions, double reach,
                            WatchedExecution* execution) {
    const auto to = rows<3>(positions, "positions");
    const auto corners = space_triangles(triangles);
    auto result =
        unlocked([&] { return spatial::nearest_triangles(corners, to, reach, run(execution)); });
    return py::make_tuple(to_array(std::move(result.number)), to_array(std::move(result.distance)));
}

NumpyArray<double> heights_at_distance(const NumpyArray<double>& triangles,
                                       const NumpyArray<double>& positions,
                                       const NumpyArray<double>& heights_here,
                                       const NumpyArray<double>& distance,
                                       WatchedExecution* execution) {
    const auto corners = space_triangles(triangles);
    const auto to = rows<2>(positions, "positions");
    const auto heights = view(heights_here), away = view(distance);
    return to_array(unlocked(
        [&] { return spatial::heights_at_distance(corners, to, heights, away, run(execution)); }));
}

/// The boxes around polygons (N, K, 2 or 3).
std::vector<spatial::CornersOfBox> boxes_around(const NumpyArray<double>& polygons) {
    if (polygons.ndim() != 3 || polygons.shape(2) < 2 || polygons.shape(2) > 3)
        throw py::value_error("polygons: an array of shape (any, any, 2 or 3) is needed");
    const auto corners = static_cast<std::size_t>(polygons.shape(1));
    const auto columns = static_cast<std::size_t>(polygons.shape(2));
    std::vector<spatial::CornersOfBox> boxes(static_cast<std::size_t>(polygons.shape(0)));
    const double* at = polygons.data();
    for (auto& [low, high] : boxes) {
        for (std::size_t corner = 0; corner < corners; ++corner) {
            for (std::size_t k = 0; k < columns; ++k, ++at) {
                if (!std::isfinite(*at)) throw py::value_error("polygons: not finite");
                low[k] = corner == 0 ? *at : std::min(low[k], *at);
                high[k] = corner == 0 ? *at : std::max(high[k], *at);
            }
        }
    }
    return boxes;
}

NumpyArray<std::int64_t> meeting_boxes(const NumpyArray<double>& first,
                                       const NumpyArray<double>& second) {
    const auto one = boxes_around(first), other = boxes_around(second);
    return to_array(unlocked([&] { return spatial::meeting_boxes(one, other); }));
}

NumpyArray<std::int8_t> orient2d(const NumpyArray<double>& a, const NumpyArray<double>& b,
                                 const NumpyArray<double>& c) {
    std::vector<std::int8_t> turns =
        spatial::turns(rows<2>(a, "a"), rows<2>(b, "b"), rows<2>(c, "c"));
    return to_array(std::move(turns));
}

}  // namespace

void bind_spatial(py::module_& module) {
    using py::arg;
    module.def("nearest_points", &nearest_points, arg("points"), arg("positions"), arg("count") = 1,
               arg("execution") = py::none(),
               R"(The count nearest of points (P, 2) to each position (N, 2), nearest first.

Returns number (N, count) int32, of points at one distance the lowest first, -1 for none, and distance
(N, count) float64, infinite for none. Raises InputError: kind "no_points", "not_finite"; Cancelled.)");
    module.def("nearest_triangles", &nearest_triangles, arg("triangles"), arg("positions"),
               arg("reach") = HUGE_VAL, arg("execution") = py::none(),
               R"(The nearest of triangles (T, 3, 3) that are nearer than reach to positions (N, 3).

Returns number (N,) int32, of triangles at one distance the lowest, -1 for none, and distance (N,)
float64, infinite for none. Raises Cancelled.)");
    module.def("heights_at_distance", &heights_at_distance, arg("triangles"), arg("positions"),
               arg("own"), arg("distance"), arg("execution") = py::none(),
               R"(The greatest heights at which positions (N, 2) are at a distance from a sheet.

triangles (T, 3, 3): of the sheet, which goes on far enough around the positions. own: (N,) its heights
there; distance: (N,). Returns (N,) float64: at them no triangle is nearer, up to rounding; NaN where own
is NaN, and own where the distance is not positive. Raises InputError: kind "bad_index"; Cancelled.)");
    module.def(
        "meeting_boxes", &meeting_boxes, arg("first"), arg("second"),
        R"(The pairs (K, 2) int64 of polygons (N, K, D) and (M, L, D), D 2 or 3, whose boxes meet.

They are in the order of the fewer polygons; those of each in the order of the least x of the others.)");
    module.def(
        "orient2d", &orient2d, arg("a"), arg("b"), arg("c"),
        R"(Which way the paths from a over b to c, (N, 2) each, turn: 1 left, -1 right, 0 straight on; exact.

Returns (N,) int8.)");
}

}  // namespace realmodel::bindings
