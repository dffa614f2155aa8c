// SPDX-License-Identifier: GPL-3.0-or-later
// cut_by_plane, cut_by_surface, cut_by_block, section_by_plane, fence_panel, triangulate_faces.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <utility>

#include "arrays.hpp"
#include "complex_arrays.hpp"
#include "execution.hpp"
#include "realmodel/cutting/cut.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

struct ModelArrays : ComplexArrays {
    explicit ModelArrays(const py::dict& arrays) : ComplexArrays(arrays) {
        complex.blocks = arrays["blocks"].cast<std::size_t>();
        complex.surfaces = static_cast<std::int32_t>(complex.blocks);
        if (arrays["cell_kind"].cast<std::string>() == "blocks")
            complex.cell_kind = CellKind::kBlocks;
    }
};

py::dict to_dict(CellComplex&& complex, std::vector<std::int32_t>&& origin) {
    py::dict result = complex_arrays(complex);
    result["cells"] = to_array(std::move(origin));
    return result;
}

py::dict to_dict(cutting::Section&& section) {
    py::dict result;
    result["vertices"] = to_array(std::move(section.vertices));
    result["offsets"] = to_array(std::move(section.offsets));
    result["polygon_vertices"] = to_array(std::move(section.polygon_vertices));
    result["cells"] = to_array(std::move(section.cells));
    return result;
}

py::dict to_dict(cutting::Cut&& cut) {
    py::dict result;
    result["below"] = to_dict(std::move(cut.below), std::move(cut.below_cells));
    result["above"] = to_dict(std::move(cut.above), std::move(cut.above_cells));
    result["section"] = to_dict(std::move(cut.section));
    result["below_touches"] = cut.below_touches;
    result["above_touches"] = cut.above_touches;
    return result;
}

py::dict cut_by_plane(const py::dict& model, const std::array<double, 3>& point,
                      const std::array<double, 3>& normal, WatchedExecution* execution) {
    const ModelArrays arrays(model);
    return to_dict(unlocked([&] {
        return cutting::cut_by_plane(arrays.complex, {point, normal}, run(execution));
    }));
}

py::dict cut_by_surface(const py::dict& model, const NumpyArray<double>& vertices,
                        const NumpyArray<std::int32_t>& triangles, WatchedExecution* execution) {
    require_columns(vertices, 3, "vertices of the surface");
    require_columns(triangles, 3, "triangles of the surface");
    const ModelArrays arrays(model);
    return to_dict(unlocked([&] {
        return cutting::cut_by_surface(arrays.complex, {view(vertices), view(triangles)},
                                       run(execution));
    }));
}

py::dict cut_by_block(const py::dict& model, const py::dict& other, std::int32_t block,
                      WatchedExecution* execution) {
    const ModelArrays arrays(model), others(other);
    return to_dict(unlocked([&] {
        return cutting::cut_by_block(arrays.complex, others.complex, block, run(execution));
    }));
}

py::dict section_by_plane(const py::dict& model, const std::array<double, 3>& point,
                          const std::array<double, 3>& normal, WatchedExecution* execution) {
    const ModelArrays arrays(model);
    return to_dict(unlocked([&] {
        return cutting::section_by_plane(arrays.complex, {point, normal}, run(execution));
    }));
}

py::dict fence_panel(const py::dict& model, const std::array<double, 2>& start,
                     const std::array<double, 2>& end, WatchedExecution* execution) {
    const ModelArrays arrays(model);
    return to_dict(
        unlocked([&] { return cutting::fence_panel(arrays.complex, start, end, run(execution)); }));
}

std::tuple<NumpyArray<std::int32_t>, NumpyArray<std::int64_t>> triangulate_faces(
    const NumpyArray<double>& vertices, const NumpyArray<std::int64_t>& face_offsets,
    const Indices& face_vertices, WatchedExecution* execution) {
    require_columns(vertices, 3, "vertices");
    const auto positions = view(vertices);
    const auto offsets = view(face_offsets);
    const std::span<const std::int32_t> corners(face_vertices.data(),
                                                static_cast<std::size_t>(face_vertices.size()));
    auto triangulation = unlocked(
        [&] { return cutting::triangulate_faces(positions, offsets, corners, run(execution)); });
    return {to_array(std::move(triangulation.triangles)),
            to_array(std::move(triangulation.offsets))};
}

}  // namespace

void bind_cutting(py::module_& module) {
    module.def(
        "cut_by_plane", &cut_by_plane, py::arg("model"), py::arg("point"), py::arg("normal"),
        py::arg("execution") = py::none(),
        R"(A model cut by a plane into what lies below and above it (where the normal points).

model: dict of the arrays of docs/dev/geometry.md, and "blocks" (number of blocks) and "cell_kind".
Returns a dict: "below" and "above", each with the arrays of a model, "volumes" (B,) and "cells"
(C,) int32, the model's cell that each is part of; "section" as of section_by_plane; "below_touches",
"above_touches": whether cells of a half use an edge more than twice though the model's do not. Raises
InputError kinds not_finite, bad_plane, bad_model, and Cancelled.)");
    module.def(
        "cut_by_surface", &cut_by_surface, py::arg("model"), py::arg("vertices"),
        py::arg("triangles"), py::arg("execution") = py::none(),
        R"(A model cut by a triangulated surface, vertices (N, 3) float64, triangles (T, 3) int32, that
parts it; as cut_by_plane. Above is the surface's upper side, or the outside of a closed one. Raises
InputError kinds not_finite, bad_index, no_triangles, branching, one_sided, ends_inside, two_sides,
bad_model, and Cancelled.)");
    module.def(
        "cut_by_block", &cut_by_block, py::arg("model"), py::arg("other"), py::arg("block"),
        py::arg("execution") = py::none(),
        R"(A model cut by the boundary of a block of another model, or of itself; as cut_by_plane,
"below" is what is inside. Raises InputError kinds no_block, bad_model, and Cancelled.)");
    module.def(
        "section_by_plane", &section_by_plane, py::arg("model"), py::arg("point"),
        py::arg("normal"), py::arg("execution") = py::none(),
        R"(The section alone: vertices (V, 3) float64, offsets (K + 1,) int64, polygon_vertices
int32, convex polygons counter-clockwise seen from above; cells (K, 2) int32, the cells below and
above, -1 outside.)");
    module.def("fence_panel", &fence_panel, py::arg("model"), py::arg("start"), py::arg("end"),
               py::arg("execution") = py::none(),
               "The vertical section over the stretch from start to end, (x, y) each; as of "
               "section_by_plane, above is to its right.");
    module.def(
        "triangulate_faces", &triangulate_faces, py::arg("vertices"), py::arg("face_offsets"),
        py::arg("face_vertices"), py::arg("execution") = py::none(),
        R"(Faces divided into triangles, turned as the faces are, always the same for the same face.

vertices: (V, 3) float64; face_offsets: (F + 1,) int64; face_vertices: int32. Returns triangles (T, 3) int32,
vertex numbers, face after face, and offsets (F + 1,) int64: where those of each face begin. Each edge of a
face is an edge of one of its triangles. Raises InputError kind "bad_index" (items: the face); Cancelled.)");
}

}  // namespace realmodel::bindings
