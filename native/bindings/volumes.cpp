// SPDX-License-Identifier: GPL-3.0-or-later
// cell_volumes.
#include <pybind11/pybind11.h>

#include <vector>

#include "arrays.hpp"
#include "execution.hpp"
#include "realmodel/strata/cell_volumes.hpp"
#include "rock_arrays.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

NumpyArray<double> cell_volumes(const NumpyArray<double>& vertices,
                                const NumpyArray<std::int64_t>& face_offsets,
                                const Indices& face_vertices, const Indices& face_cells,
                                std::size_t cells, WatchedExecution* execution) {
    const auto positions = rows<3, double>(vertices, "vertices");
    const auto sides = rows<2, std::int32_t>(face_cells, "face_cells");
    return to_array(unlocked([&] {
        return strata::cell_volumes(positions, view(face_offsets), view(face_vertices), sides,
                                    cells, run(execution));
    }));
}

}  // namespace

void bind_volumes(py::module_& module) {
    module.def("cell_volumes", &cell_volumes, py::arg("vertices"), py::arg("face_offsets"),
               py::arg("face_vertices"), py::arg("face_cells"), py::arg("cells"),
               py::arg("execution") = py::none(),
               R"(Volume of every cell.

vertices: (V, 3) float64; face_offsets: (F + 1,) int64; face_vertices: int32; face_cells: (F, 2) int32, the
cells on both sides of each face, -1 outside; cells: how many there are. Returns (cells,) float64.
Raises InputError kind "bad_index" (items: the face); Cancelled.)");
}

}  // namespace realmodel::bindings
