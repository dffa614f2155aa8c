// SPDX-License-Identifier: GPL-3.0-or-later
// mesh_region, estimate_region_mesh, triangulate_rings, triangulate_polygon.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "execution.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/ear_clipping.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/meshing/triangulation.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

std::vector<meshing::PlanPoint> to_places(const NumpyArray<double>& array, const char* name) {
    const auto places = rows<2>(array, name);
    return {places.begin(), places.end()};
}

std::vector<meshing::Ring> to_rings(const std::vector<NumpyArray<double>>& arrays,
                                    const char* name = "rings") {
    std::vector<meshing::Ring> rings;
    rings.reserve(arrays.size());
    for (const NumpyArray<double>& array : arrays)
        rings.push_back(to_places(array, name));
    return rings;
}

/// vertices (V, 2), triangles (T, 3)
using PlanarArrays = std::tuple<NumpyArray<double>, NumpyArray<std::int32_t>>;

PlanarArrays to_tuple(meshing::PlanarMesh&& mesh) {
    return {to_array(std::move(mesh.vertices)), to_array(std::move(mesh.triangles))};
}

meshing::Mesher to_mesher(const std::string& name) {
    std::string known;
    for (std::size_t mesher = 0; mesher < std::size(meshing::kMesherNames); ++mesher) {
        if (meshing::kMesherNames[mesher] == name) return static_cast<meshing::Mesher>(mesher);
        known += (mesher == 0 ? "\"" : ", \"") + std::string(meshing::kMesherNames[mesher]) + "\"";
    }
    throw InputError("mesher", "mesher \"" + name + "\" is not known; use " + known);
}

/// (places or None for the outlines, length, distance)
using Size = std::tuple<std::optional<NumpyArray<double>>, double, double>;

/// The value of a key, or the default where it is not there.
template <class T>
T value_of(const py::dict& of, const char* key, T otherwise) {
    return of.contains(key) ? py::cast<T>(of[key]) : std::move(otherwise);
}

meshing::MeshRequest to_request(const py::dict& of) {
    meshing::MeshRequest request;
    request.mesher = to_mesher(value_of<std::string>(of, "mesher", "delaunay"));
    request.edge_length = py::cast<double>(of["edge_length"]);
    request.triangles = value_of(of, "triangles", 0.0);
    for (const auto& [line, length, distance] : value_of<std::vector<Size>>(of, "sizes", {})) {
        meshing::LocalLength& size = request.sizes.emplace_back();
        if (line) size.line = to_places(*line, "sizes");
        size.length = length;
        size.distance = distance;
    }
    using Places = std::optional<NumpyArray<double>>;
    request.constraints.lines =
        to_rings(value_of<std::vector<NumpyArray<double>>>(of, "constraints", {}), "constraints");
    if (const auto points = value_of<Places>(of, "constraint_points", {}))
        request.constraints.points = to_places(*points, "constraint_points");
    if (const auto density = value_of<Places>(of, "density", {}))
        request.density = to_places(*density, "density");
    return request;
}

PlanarArrays mesh_region(const std::vector<NumpyArray<double>>& rings, const py::dict& asked,
                         WatchedExecution* execution) {
    const std::vector<meshing::Ring> region = to_rings(rings);
    const meshing::MeshRequest request = to_request(asked);
    return to_tuple(
        unlocked([&] { return meshing::mesh_region(region, request, run(execution).progress); }));
}

std::tuple<double, double> estimate_region_mesh(const std::vector<NumpyArray<double>>& rings,
                                                const py::dict& asked,
                                                WatchedExecution* execution) {
    const std::vector<meshing::Ring> region = to_rings(rings);
    const meshing::MeshRequest request = to_request(asked);
    const py::gil_scoped_release release;
    const meshing::MeshEstimate estimate =
        meshing::estimate_region_mesh(region, request, run(execution).progress);
    return {estimate.triangles, estimate.bytes};
}

PlanarArrays triangulate_rings(const std::vector<NumpyArray<double>>& rings) {
    const std::vector<meshing::Ring> region = to_rings(rings);
    return to_tuple(unlocked([&] { return meshing::triangulate_rings(region); }));
}

NumpyArray<std::int32_t> triangulate_polygon(const std::vector<NumpyArray<double>>& rings,
                                             WatchedExecution* execution) {
    const std::vector<meshing::Ring> polygon = to_rings(rings);
    return to_array(
        unlocked([&] { return meshing::triangulate_polygon(polygon, run(execution).progress); }));
}

}  // namespace

void bind_meshing(py::module_& module) {
    module.def("mesh_region", &mesh_region, py::arg("rings"), py::arg("request"),
               py::arg("execution") = py::none(),
               R"(Meshes what lies inside an odd number of rings.

rings      list of (N, 2) float64: outlines and holes alike, either way round
request    dict; all but edge_length may be left out:
  edge_length  length of most edges, model units; not used where triangles is above 0
  mesher       one of the names of kMesherNames (region_mesh.hpp)
  triangles    how many there should be (within 5 %); 0: as edge_length says
  sizes        list of (places (N, 2) or None, length, distance): edges are `length` long within
               `distance` of the line through the places (None: of the rings), and grow from there
               on
  constraints  list of (N, 2) float64: lines that the mesh must contain
  constraint_points  (N, 2) float64: points that it must contain
  density      (N, 2) float64: edges become half as long as these points are apart; edge_length
               may be 0 then, else it is the longest
execution  Execution, or None

Returns (vertices (V, 2) float64, triangles (T, 3) int32, counter-clockwise). The mesh's border
is the rings' corners and points added on their edges; the corners come first in `vertices`.

Raises InputError: kind "no_outline", "not_finite", "outline_degenerate", "outline_crosses",
"outline_overlaps" (items: ring and corner numbers; place), "edge_length", "triangles", "size",
"density", "constraint_not_finite", "constraint_outside", "too_large", "mesher";
Cancelled.)");
    module.def(
        "estimate_region_mesh", &estimate_region_mesh, py::arg("rings"), py::arg("request"),
        py::arg("execution") = py::none(),
        R"(What mesh_region with the same arguments will take: (triangles, bytes at the peak).

Takes and raises what mesh_region does.)");
    module.def("triangulate_rings", &triangulate_rings, py::arg("rings"),
               R"(Constrained Delaunay triangulation of what lies inside an odd number of rings.

No vertex is added. Takes, returns and raises what mesh_region does.)");
    module.def("triangulate_polygon", &triangulate_polygon, py::arg("rings"),
               py::arg("execution") = py::none(),
               R"(Triangles of a polygon by ear clipping and edge swaps to Delaunay.

rings      list of (N, 2) float64: the outline, then its holes, either way round
execution  Execution, or None

Returns (T, 3) int32, counter-clockwise: corner numbers, counted through the rings. Raises
InputError: kind "no_outline", "not_finite", "outline_degenerate", "outline_crosses",
"outline_overlaps"; Cancelled. Whether rings cross is looked for only where ears run out.)");
}

}  // namespace realmodel::bindings
