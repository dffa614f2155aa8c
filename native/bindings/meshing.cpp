// SPDX-License-Identifier: GPL-3.0-or-later
// mesh_region, triangulate_rings.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "arrays.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/meshing/region_mesh.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

std::vector<meshing::Ring> to_rings(const std::vector<Array<double>>& arrays) {
    std::vector<meshing::Ring> rings;
    rings.reserve(arrays.size());
    for (const Array<double>& array : arrays) {
        require_columns(array, 2, "rings");
        meshing::Ring& ring = rings.emplace_back();
        ring.reserve(static_cast<std::size_t>(array.shape(0)));
        for (py::ssize_t i = 0; i < array.shape(0); ++i) {
            ring.push_back({array.at(i, 0), array.at(i, 1)});
        }
    }
    return rings;
}

py::tuple to_tuple(meshing::PlanarMesh&& mesh) {
    return py::make_tuple(to_array(std::move(mesh.vertices)), to_array(std::move(mesh.triangles)));
}

py::tuple mesh_region(const std::vector<Array<double>>& rings, double edge_length,
                      const std::string& mesher, Progress* control) {
    if (mesher != "delaunay") {
        throw InputError("mesher", "mesher \"" + mesher + "\" is not known; use \"delaunay\"");
    }
    const std::vector<meshing::Ring> region = to_rings(rings);
    meshing::PlanarMesh mesh;
    {
        const py::gil_scoped_release unlocked;
        mesh = meshing::mesh_region(region, edge_length, control);
    }
    return to_tuple(std::move(mesh));
}

py::tuple triangulate_rings(const std::vector<Array<double>>& rings) {
    const std::vector<meshing::Ring> region = to_rings(rings);
    meshing::PlanarMesh mesh;
    {
        const py::gil_scoped_release unlocked;
        mesh = meshing::triangulate_rings(region);
    }
    return to_tuple(std::move(mesh));
}

}  // namespace

void bind_meshing(py::module_& module) {
    module.def("mesh_region", &mesh_region, py::arg("rings"), py::arg("edge_length"),
               py::arg("mesher") = "delaunay", py::arg("control") = py::none(),
               R"(Meshes what lies inside an odd number of rings.

rings        list of (N, 2) float64: outlines and holes alike, either way round
edge_length  length of most edges, model units
mesher       "delaunay"
control      Control to watch and stop it, or None

Returns (vertices (V, 2) float64, triangles (T, 3) int32, counter-clockwise). The mesh's border
is the rings' corners and points added on their edges; the corners come first in `vertices`.

Raises InputError: kind "no_outline", "not_finite", "outline_degenerate", "outline_crosses",
"outline_overlaps" (items: ring and corner numbers; place), "edge_length", "too_large",
"too_close", "mesher"; Cancelled.)");
    module.def("triangulate_rings", &triangulate_rings, py::arg("rings"),
               R"(Constrained Delaunay triangulation of what lies inside an odd number of rings.

No vertex is added. Takes, returns and raises what mesh_region does.)");
}

}  // namespace realmodel::bindings
