// SPDX-License-Identifier: GPL-3.0-or-later
// polygon_edges, block_shells, cell_shells.
#include "realmodel/shells/shells.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "complex_arrays.hpp"
#include "execution.hpp"
#include "rock_arrays.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

using Position = std::array<double, 3>;

std::tuple<NumpyArray<std::int32_t>, NumpyArray<std::int32_t>> polygon_edges(const Indices& offsets,
                                                                             const Indices& corners,
                                                                             std::size_t vertices) {
    const auto begins = view(offsets), numbers = view(corners);
    auto result = unlocked([&] { return shells::polygon_edges(begins, numbers, vertices); });
    return {to_array(std::move(result.edges)), to_array(std::move(result.of_corner))};
}

py::list shell_arrays(std::vector<shells::Shell>&& shells) {
    py::list arrays;
    for (shells::Shell& shell : shells) {
        if (shell.faces.empty()) {
            arrays.append(py::none());
            continue;
        }
        arrays.append(py::make_tuple(
            to_array(std::move(shell.coordinates)), to_array(std::move(shell.offsets)),
            to_array(std::move(shell.corners)), to_array(std::move(shell.faces)),
            to_array(std::move(shell.reversed)).attr("view")("bool"),
            to_array(std::move(shell.edges.edges)), to_array(std::move(shell.edges.of_corner))));
    }
    return arrays;
}

py::list complex_shells(const py::dict& model, std::size_t blocks, const Position& origin,
                        std::optional<double> shrink, WatchedExecution* execution) {
    ComplexArrays arrays(model);
    ComplexView& complex = arrays.complex;
    complex.blocks = blocks;
    return shell_arrays(unlocked([&] {
        return shrink ? shells::cell_shells(complex, *shrink, origin, run(execution))
                      : shells::block_shells(complex, origin, run(execution));
    }));
}

}  // namespace

void bind_shells(py::module_& module) {
    module.def("polygon_edges", &polygon_edges, py::arg("offsets"), py::arg("corners"),
               py::arg("vertices"),
               R"(The edges of polygons.

offsets (F + 1,) int32: where the corners of each polygon begin, and where the last end; corners (C,)
int32: vertex numbers; vertices: how many there are. Returns edges (E, 2) int32, each once, the lower
vertex first, and for each corner (C,) int32 the edge from it to the next corner of its polygon.
Raises InputError kind "bad_index" (items: the polygon).)");
    module.def("complex_shells", &complex_shells, py::arg("model"), py::arg("blocks"),
               py::arg("origin"), py::arg("shrink") = py::none(), py::arg("execution") = py::none(),
               R"(The blocks of a cell complex as closed meshes of polygons.

model: the arrays of docs/dev/geometry.md; blocks: how many there are; origin: three numbers that are
taken off the coordinates before they are rounded. shrink: None for the boundary of each block; else
each cell stands by itself, its own vertices drawn towards their mean by this factor.

Returns for each block None where it has no cells, or (coordinates (V, 3) float32, offsets (F + 1,) and
corners (C,) int32, counter-clockwise seen from outside, faces (F,) int32 of the complex, reversed (F,) bool
(it is the side of the face's second cell), edges (E, 2)
and for each corner its edge (C,) int32, as polygon_edges has them); the same for any number of threads.
Raises InputError kind "bad_index", "too_large"; Cancelled.)");
}

}  // namespace realmodel::bindings
