// SPDX-License-Identifier: GPL-3.0-or-later
// intersect and Refinement.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>

#include "arrays.hpp"
#include "execution.hpp"
#include "realmodel/booleans/intersect.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

using booleans::Refinement;

/// An array that looks at memory of a Refinement, which it keeps alive.
template <class T>
py::array_t<T> seen(const py::object& owner, const T* values, std::vector<py::ssize_t> shape) {
    py::array_t<T> array(std::move(shape), values, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

template <class T>
py::array_t<T> seen(const py::object& owner, const std::vector<T>& values) {
    return seen(owner, values.data(), {static_cast<py::ssize_t>(values.size())});
}

py::array_t<std::int32_t> rows_seen(const py::object& owner,
                                    const std::vector<std::array<std::int32_t, 3>>& triangles) {
    static_assert(sizeof(std::array<std::int32_t, 3>) == 3 * sizeof(std::int32_t));
    return seen(owner, reinterpret_cast<const std::int32_t*>(triangles.data()),
                {static_cast<py::ssize_t>(triangles.size()), 3});
}

const Refinement& in(const py::object& self) {
    return self.cast<const Refinement&>();
}

const char* name_of(booleans::LoopKind kind) {
    switch (kind) {
        case booleans::LoopKind::kOpen:
            return "open";
        case booleans::LoopKind::kHardClosed:
            return "hard_closed";
        default:
            return "soft_closed";
    }
}

py::list loops(const py::object& self) {
    py::list tuples;
    for (const auto& loop : in(self).loops)
        tuples.append(py::make_tuple(name_of(loop.kind), seen(self, loop.vertices)));
    return tuples;
}

py::list sub_surfaces(const py::object& self) {
    py::list tuples;
    for (const auto& sub_surface : in(self).sub_surfaces)
        tuples.append(py::make_tuple(sub_surface.source, seen(self, sub_surface.triangles),
                                     seen(self, sub_surface.loops), sub_surface.is_public));
    return tuples;
}

py::list sub_blocks(const py::object& self) {
    py::list tuples;
    for (const auto& block : in(self).sub_blocks)
        tuples.append(py::make_tuple(rows_seen(self, block.triangles), in(self).volume(block),
                                     block.is_in[0], block.is_in[1]));
    return tuples;
}

py::array_t<bool> is_in(const py::object& self) {
    const auto& values = in(self).is_in;
    static_assert(sizeof(values[0]) == 4 * sizeof(bool));
    return seen(self, reinterpret_cast<const bool*>(values.data()),
                {static_cast<py::ssize_t>(values.size()), 2, 2});
}

std::unique_ptr<Refinement> intersect(const NumpyArray<double>& first_vertices,
                                      const Indices& first_triangles,
                                      const NumpyArray<double>& second_vertices,
                                      const Indices& second_triangles,
                                      WatchedExecution* execution) {
    require_columns(first_vertices, 3, "vertices of the first surface");
    require_columns(first_triangles, 3, "triangles of the first surface");
    require_columns(second_vertices, 3, "vertices of the second surface");
    require_columns(second_triangles, 3, "triangles of the second surface");
    const TriangleView first{view(first_vertices), view(first_triangles)};
    const TriangleView second{view(second_vertices), view(second_triangles)};
    const py::gil_scoped_release release;
    return std::make_unique<Refinement>(booleans::intersect(first, second, run(execution)));
}

}  // namespace

void bind_booleans(py::module_& module) {
    py::class_<Refinement>(module, "Refinement",
                           "Two surfaces divided along one another. Its arrays are no copies, and "
                           "cannot be written to.")
        .def_property_readonly(
            "vertices",
            [](const py::object& self) {
                const auto& values = in(self).vertices;
                return seen(self, values.data(), {static_cast<py::ssize_t>(values.size() / 3), 3});
            },
            "(V, 3) float64.")
        .def_property_readonly(
            "triangles", [](const py::object& self) { return rows_seen(self, in(self).triangles); },
            "(T, 3) int32.")
        .def_property_readonly(
            "source", [](const py::object& self) { return seen(self, in(self).source); },
            "(T,) uint8: 0, of the first surface, or 1, of the second.")
        .def_property_readonly(
            "source_triangle",
            [](const py::object& self) { return seen(self, in(self).source_triangle); },
            "(T,) int32: the triangle of that surface that each is part of.")
        .def_property_readonly(
            "coinciding", [](const py::object& self) { return seen(self, in(self).coinciding); },
            "(T,) int32: the first triangle that has the same corners.")
        .def_property_readonly("is_in", &is_in,
                               "(T, 2, 2) bool: whether it is inside of surface [:, i], just below "
                               "[:, :, 0] and just above [:, :, 1] each triangle; of those that "
                               "coincide the first counts.")
        .def_property_readonly("loops", &loops, "List of (kind, vertices int32).")
        .def_property_readonly("sub_surfaces", &sub_surfaces,
                               "List of (source, triangles int32, loops int32, is_public).")
        .def_property_readonly("sub_blocks", &sub_blocks,
                               "List of (triangles (K, 3) int32, volume, in_a, in_b).")
        .def_readonly("is_closed", &Refinement::is_closed,
                      "[bool, bool]: whether each surface is the boundary of a solid.");

    module.def("intersect", &intersect, py::arg("first_vertices"), py::arg("first_triangles"),
               py::arg("second_vertices"), py::arg("second_triangles"),
               py::arg("execution") = py::none(),
               R"(Intersects two triangulated surfaces and returns a Refinement.

vertices (N, 3) float64, triangles (T, 3) int32 of each. Raises InputError kinds not_finite, bad_index,
no_triangles, too_large, too_close (surface: which of the two), and Cancelled.)");
}

}  // namespace realmodel::bindings
