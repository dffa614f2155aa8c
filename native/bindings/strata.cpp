// SPDX-License-Identifier: GPL-3.0-or-later
// build_rock_masses, build_tile, find_joins, build_stack, cell_components, cell_sides.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "complex_arrays.hpp"
#include "execution.hpp"
#include "realmodel/strata/cell_components.hpp"
#include "realmodel/strata/joins.hpp"
#include "realmodel/strata/stack.hpp"
#include "rock_arrays.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

std::vector<strata::StackInput> views_of(const std::vector<RockArrays>& rocks) {
    std::vector<strata::StackInput> input;
    for (const RockArrays& rock : rocks)
        input.push_back(view_of(rock));
    return input;
}

py::dict build_rock_masses(const std::vector<RockArrays>& rocks, const std::string& cells,
                           WatchedExecution* execution) {
    const CellKind kind = kind_of(cells);
    const auto input = views_of(rocks);
    return built_arrays(unlocked([&] {
        const MemoryRelease at_the_end;
        return strata::build_rock_masses(input, run(execution), kind);
    }));
}

py::dict build_tile(const std::vector<RockArrays>& rocks, const std::array<double, 4>& window,
                    const std::string& cells, WatchedExecution* execution) {
    const CellKind kind = kind_of(cells);
    const auto input = views_of(rocks);
    strata::Tile tile;
    std::vector<std::int32_t> numbers;
    std::vector<double> nearest;
    std::string exact;
    {
        const py::gil_scoped_release release;
        const MemoryRelease at_the_end;
        tile = strata::build_tile(input, {window[0], window[1], window[2], window[3]},
                                  run(execution), kind);
        for (const strata::BorderVertex& vertex : tile.border) {
            numbers.push_back(vertex.vertex);
            nearest.insert(nearest.end(), vertex.nearest.begin(), vertex.nearest.end());
            const auto& [x, y, z] = vertex.exact;
            exact += x + ' ' + y + ' ' + z + '\n';
        }
    }
    py::dict result = built_arrays(std::move(tile.complex));
    result["border_vertices"] = to_array(std::move(numbers));
    result["border_nearest"] = to_array(std::move(nearest), 3);
    result["border_exact"] = py::bytes(exact);
    return result;
}

std::optional<strata::Joins> find_joins(const std::vector<RockArrays>& rocks, bool borders,
                                        WatchedExecution* execution) {
    const auto input = views_of(rocks);
    const py::gil_scoped_release release;
    const MemoryRelease at_the_end;
    return strata::find_joins(input, borders, run(execution));
}

/// The columns of vertices of a surface or a region.
std::size_t columns_of(const NumpyArray<double>& vertices) {
    const std::size_t columns = vertices.ndim() == 2 && vertices.shape(1) == 2 ? 2 : 3;
    require_columns(vertices, columns, "vertices");
    return columns;
}

std::optional<std::tuple<NumpyArray<double>, NumpyArray<std::int32_t>>> joined_mesh(
    const strata::Joins& joins, const NumpyArray<double>& vertices, const Indices& triangles,
    WatchedExecution* execution) {
    const std::size_t columns = columns_of(vertices);
    require_columns(triangles, 3, "triangles");
    auto mesh = unlocked([&] {
        const MemoryRelease at_the_end;
        return joins.mesh({view(vertices), view(triangles)}, columns, run(execution));
    });
    if (!mesh) return std::nullopt;
    return std::tuple(to_array(std::move(mesh->vertices), columns),
                      to_array(std::move(mesh->triangles), 3));
}

NumpyArray<double> snapped(const strata::Joins& joins, const NumpyArray<double>& vertices) {
    const std::size_t columns = columns_of(vertices);
    auto output = unlocked([&] { return joins.snapped(view(vertices), columns); });
    return to_array(std::move(output), columns);
}

py::dict build_stack(const std::vector<SurfaceArrays>& surfaces,
                     const std::optional<SurfaceArrays>& region,
                     std::optional<double> base_elevation, const std::string& cells,
                     WatchedExecution* execution, const std::vector<std::string>& rules) {
    return build_rock_masses({{surfaces, region, base_elevation, rules}}, cells, execution);
}

std::tuple<NumpyArray<std::uint32_t>, NumpyArray<std::uint32_t>> cell_sides(
    const Indices& face_cells, std::size_t cells, WatchedExecution* execution) {
    const auto faces = rows<2>(face_cells, "face_cells");
    auto output =
        unlocked([&] { return strata::faces_of_cells(faces, cells, run(execution).progress); });
    return {to_array(std::move(output.offsets)), to_array(std::move(output.faces))};
}

NumpyArray<std::int32_t> cell_components(const Indices& face_cells, const Indices& cell_block,
                                         WatchedExecution* execution) {
    const auto faces = rows<2>(face_cells, "face_cells");
    return to_array(unlocked(
        [&] { return strata::cell_components(faces, view(cell_block), run(execution).progress); }));
}

}  // namespace

void bind_strata(py::module_& module) {
    module.def("build_rock_masses", &build_rock_masses, py::arg("rocks"),
               py::arg("cells") = "columns", py::arg("execution") = py::none(),
               R"(All blocks of rock masses, which may share borders but no area in plan.

rocks: list of (surfaces, region, base_elevation, rules). surfaces: list of (vertices (V, 3)
float64, triangles (T, 3) int32), oldest first; region: None or a triangulation (vertices (R, 2)
float64, triangles (Q, 3) int32) whose border clips them; base_elevation: None or the height of a
flat base; rules: one a surface, names of kRules in stack.hpp (none: all erosional). cells:
"columns" or "blocks" (each connected part of a block one cell). Surfaces are counted through all rock
masses. Returns a dict of arrays: vertices (V, 3)
float64, face_offsets (F + 1,) int64, face_vertices int32, face_cells (F, 2) int32, face_surface
(F,) int32 (-1 a wall, -2 a base), cell_block (C,) int32 (the surface that the cell's block lies
beneath; the oldest of a rock mass: above its base), volumes (S,) float64; warnings: list of (kind,
surface, items, text); decisions, exact_decisions: int. Raises InputError and Cancelled.)");
    module.def("build_tile", &build_tile, py::arg("rocks"), py::arg("window"),
               py::arg("cells") = "columns", py::arg("execution") = py::none(),
               R"(build_rock_masses of what lies in a window (low x, low y, high x, high y).

Borders are taken as they are: those of all of the model are to be joined before (find_joins). And
what lies on the lines that bound it: border_vertices (N,) int32, ascending, no other vertex has a
coordinate of these; border_nearest (N, 3) float64, the doubles nearest to where they are exactly;
border_exact: bytes, a line with x, y and z of each, reduced fractions in hexadecimal, which are
equal where points are, in all tiles.)");
    py::class_<strata::Joins>(
        module, "Joins",
        "What differs in the plan coordinates and borders of rock masses by rounding alone.")
        .def_property_readonly(
            "text", [](const strata::Joins& joins) { return joins.warning().text; },
            "The warning of build_rock_masses where it joins the same.")
        .def("mesh", &joined_mesh, py::arg("vertices"), py::arg("triangles"),
             py::arg("execution") = py::none(),
             R"(A mesh of these rock masses as build_rock_masses builds it.

vertices: (V, 3) float64, of a region (V, 2); triangles: (T, 3) int32. Returns (vertices, triangles) as new
arrays; triangles that are not divided keep their numbers. Or None, where the mesh would not be single-valued:
then all meshes are built as they are given, also after an InputError. Raises InputError and Cancelled.)")
        .def("snapped", &snapped, py::arg("vertices"),
             R"(The vertices of a mesh with plan coordinates that differ by rounding alone made one.

vertices: (V, 3) float64, of a region (V, 2). Returns a new array.)");
    module.def(
        "find_joins", &find_joins, py::arg("rocks"), py::arg("borders") = true,
        py::arg("execution") = py::none(),
        R"(What build_rock_masses joins in its input before it builds, as Joins; None where that is nothing.

rocks: as build_rock_masses takes them. borders: whether borders are compared, too, or plan coordinates alone.
Takes the memory of some millions of coordinates, and of one mesh. Raises InputError and Cancelled.)");
    module.def("build_stack", &build_stack, py::arg("surfaces"), py::arg("region") = py::none(),
               py::arg("base_elevation") = py::none(), py::arg("cells") = "columns",
               py::arg("execution") = py::none(), py::arg("rules") = std::vector<std::string>(),
               "build_rock_masses of a single rock mass.");
    module.def("cell_components", &cell_components, py::arg("face_cells"), py::arg("cell_block"),
               py::arg("execution") = py::none(),
               R"(Connected parts of blocks.

face_cells: (F, 2) int32, the cells on both sides of each face, -1 outside; cell_block: (C,) int32.
Returns (C,) int32: for each cell the least cell that it reaches through faces between cells of its
own block. Raises InputError kind "bad_index" (items: the face); Cancelled.)");
    module.def("cell_sides", &cell_sides, py::arg("face_cells"), py::arg("cells"),
               py::arg("execution") = py::none(),
               R"(The sides of each cell, in the order of the faces.

face_cells: (F, 2) int32, the cells on both sides of each face, -1 outside; cells: how many there are.
Returns (offsets (C + 1,) uint32, sides (S,) uint32): those of cell c are sides[offsets[c]:offsets[c +
1]], each 2 face + 1 where the cell is the face's second one, else 2 face. Raises InputError kind
"bad_index" (items: the face), "too_large"; Cancelled.)");
}

}  // namespace realmodel::bindings
