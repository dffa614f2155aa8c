// SPDX-License-Identifier: GPL-3.0-or-later
// simulation_lines, layered_mesh, filled_mesh, clean_cells, describe_cells, inner_faces,
// ordered_faces.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "complex_arrays.hpp"
#include "execution.hpp"
#include "realmodel/simulation/clean_cells.hpp"
#include "realmodel/simulation/face_lists.hpp"
#include "realmodel/simulation/filled_mesh.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

using simulation::LayeredMesh;
using simulation::PlanLines;

/// (places or None for all lines, length, distance)
using Size = std::tuple<std::optional<NumpyArray<double>>, double, double>;

/// As LineLength or LocalLength.
template <class Length>
std::vector<Length> lengths_of(const std::vector<Size>& sizes) {
    std::vector<Length> lengths;
    for (const auto& [line, length, distance] : sizes) {
        Length& local_length = lengths.emplace_back();
        if (line) {
            const auto places = rows<2, double>(*line, "sizes");
            local_length.line.assign(places.begin(), places.end());
        }
        local_length.length = length;
        local_length.distance = distance;
    }
    return lengths;
}

std::unique_ptr<PlanLines> simulation_lines(const py::dict& model, const Indices& block_rock,
                                            double edge_length, const std::vector<Size>& sizes,
                                            WatchedExecution* execution) {
    ComplexArrays arrays(model);
    arrays.complex.blocks = static_cast<std::size_t>(block_rock.size());
    const auto lengths = lengths_of<simulation::LineLength>(sizes);
    const py::gil_scoped_release release;
    return std::make_unique<PlanLines>(simulation::plan_lines(
        arrays.complex, view(block_rock), edge_length, lengths, run(execution)));
}

py::list rings_of(const PlanLines& lines) {
    py::list rings;
    for (meshing::Ring ring : lines.rings)
        rings.append(to_array(std::move(ring)));
    return rings;
}

std::vector<std::array<std::int32_t, 5>> segment_rows(const PlanLines& lines) {
    std::vector<std::array<std::int32_t, 5>> rows;
    for (const simulation::PlanSegment& s : lines.segments)
        rows.push_back({s.from, s.to, s.left_rock, s.right_rock, s.is_step ? 1 : 0});
    return rows;
}
NumpyArray<std::int32_t> segments_of(const PlanLines& lines) {
    return to_array(segment_rows(lines));
}

/// Lines inside the region, (2, 2) each.
py::list inner_lines(const PlanLines& lines) {
    py::list result;
    for (const simulation::PlanSegment& s : lines.segments) {
        if (s.left_rock < 0 || s.right_rock < 0) continue;
        result.append(to_array(
            std::vector<meshing::PlanPoint>{lines.points[static_cast<std::size_t>(s.from)],
                                            lines.points[static_cast<std::size_t>(s.to)]}));
    }
    return result;
}

template <std::size_t N>
py::dict elements_dict(LayeredMesh::Elements<N>& elements) {
    py::dict made;
    made["corners"] = to_array(std::move(elements.corners));
    made["block"] = to_array(std::move(elements.block));
    made["column"] = to_array(std::move(elements.column));
    made["layer"] = to_array(std::move(elements.layer));
    return made;
}

template <std::size_t N>
py::tuple faces_tuple(LayeredMesh::Faces<N>& faces) {
    return py::make_tuple(to_array(std::move(faces.corners)), to_array(std::move(faces.surface)));
}

py::dict layered_mesh(const py::dict& model, const Indices& block_rock, const PlanLines& lines,
                      const NumpyArray<double>& vertices, const Indices& triangles,
                      double minimum_thickness, const std::vector<std::int32_t>& layers,
                      double layer_thickness, bool divided, WatchedExecution* execution) {
    ComplexArrays arrays(model);
    arrays.complex.blocks = static_cast<std::size_t>(block_rock.size());
    if (layers.size() != arrays.complex.blocks) throw py::value_error("layers: one for each block");
    const auto plan_vertices = rows<2, double>(vertices, "vertices");
    const auto plan_triangles = rows<3, std::int32_t>(triangles, "triangles");
    auto mesh = unlocked([&] {
        return simulation::layered_mesh(arrays.complex, view(block_rock), lines,
                                        {{plan_vertices.begin(), plan_vertices.end()},
                                         {plan_triangles.begin(), plan_triangles.end()}},
                                        {minimum_thickness, layers, layer_thickness, divided},
                                        run(execution));
    });
    py::dict made;
    made["points"] = to_array(std::move(mesh.points));
    made["tetrahedron"] = elements_dict(mesh.tetrahedra);
    made["pyramid"] = elements_dict(mesh.pyramids);
    made["prism"] = elements_dict(mesh.prisms);
    made["triangle"] = faces_tuple(mesh.triangles);
    made["quadrilateral"] = faces_tuple(mesh.quadrilaterals);
    made["plan_vertices"] = to_array(std::move(mesh.plan.vertices));
    made["plan_triangles"] = to_array(std::move(mesh.plan.triangles));
    made["layers"] = mesh.layers;
    made["volumes"] = to_array(std::move(mesh.volumes));
    made["block_layers"] = mesh.block_layers;
    made["skewed"] =
        py::make_tuple(mesh.skewed.faces, mesh.skewed.most, mesh.skewed.place, mesh.skewed.tall);
    made["kept"] = mesh.unrepaired_blocks;
    return made;
}

py::dict filled_mesh(const py::dict& model, const Indices& cell_region,
                     const NumpyArray<std::uint8_t>& embedded, double edge_length, double tolerance,
                     const std::vector<Size>& sizes, WatchedExecution* execution) {
    const ComplexArrays arrays(model);
    const auto lengths = lengths_of<meshing::LocalLength>(sizes);
    auto mesh = unlocked([&] {
        return simulation::filled_mesh(arrays.complex, view(cell_region), view(embedded),
                                       edge_length, tolerance, lengths, run(execution));
    });
    py::dict made;
    made["points"] = to_array(std::move(mesh.points));
    made["tetrahedra"] = to_array(std::move(mesh.tetrahedra));
    made["region"] = to_array(std::move(mesh.region));
    made["triangles"] = to_array(std::move(mesh.triangles));
    made["surface"] = to_array(std::move(mesh.surface));
    return made;
}

py::dict counts_dict(const simulation::ComplexCounts& counts) {
    py::dict made;
    made["edges"] = counts.edges;
    made["faces"] = counts.faces;
    made["cells"] = counts.cells;
    return made;
}

py::dict clean_cells(const py::dict& model, std::size_t blocks, const Indices& surface_kind,
                     double tolerance, WatchedExecution* execution) {
    ComplexArrays arrays(model);
    arrays.complex.blocks = blocks;
    auto cells = unlocked([&] {
        return simulation::clean_cells(arrays.complex, view(surface_kind), tolerance,
                                       run(execution));
    });
    py::dict made = complex_arrays(cells.complex);
    made["cell_origin"] = to_array(std::move(cells.cell_origin));
    made["volumes_before"] = to_array(std::move(cells.volumes_before));
    made["before"] = counts_dict(cells.before);
    made["after"] = counts_dict(cells.after);
    made["short_edges"] = cells.short_edges;
    made["thin_cells"] = cells.thin_cells;
    made["largest_move"] = cells.largest_move;
    return made;
}

std::tuple<NumpyArray<std::int64_t>, NumpyArray<std::int64_t>, NumpyArray<std::int64_t>,
           NumpyArray<std::int64_t>>
describe_cells(const NumpyArray<std::int64_t>& face_offsets, const Indices& face_vertices,
               const NumpyArray<std::uint32_t>& begin, const NumpyArray<std::uint32_t>& sides) {
    auto result = unlocked([&] {
        return simulation::describe_cells({view(face_offsets), view(face_vertices)}, view(begin),
                                          view(sides));
    });
    return {to_array(std::move(result.faces)), to_array(std::move(result.vertices)),
            to_array(std::move(result.counts)), to_array(std::move(result.lengths))};
}

NumpyArray<std::int64_t> inner_faces(const Indices& face_cells, std::size_t cells) {
    const auto both = rows<2>(face_cells, "face_cells");
    return to_array(unlocked([&] { return simulation::inner_faces(both, cells); }));
}

py::dict ordered_faces(const NumpyArray<std::int64_t>& face_offsets, const Indices& face_vertices,
                       const Indices& face_cells, const NumpyArray<std::int64_t>& order) {
    const auto both = rows<2>(face_cells, "face_cells");
    auto result = unlocked([&] {
        return simulation::ordered_faces({view(face_offsets), view(face_vertices)}, both,
                                         view(order));
    });
    py::dict made;
    made["offsets"] = to_array(std::move(result.offsets));
    made["vertices"] = to_array(std::move(result.vertices));
    made["owner"] = to_array(std::move(result.owner));
    made["neighbor"] = to_array(std::move(result.neighbor));
    made["turned"] = to_array(std::move(result.turned));
    return made;
}

}  // namespace

void bind_simulation(py::module_& module) {
    py::class_<PlanLines>(module, "PlanLines",
                          "The lines of a model in plan, simplified to an edge length.")
        .def_property_readonly("rings", &rings_of, "(N, 2) float64 each: what bounds the region.")
        .def_property_readonly(
            "points", [](const PlanLines& lines) { return to_array(std::vector(lines.points)); },
            "(P, 2) float64: where lines begin, end and meet.")
        .def_property_readonly("segments", &segments_of,
                               "(S, 5) int32: both ends, rock masses left and right (-1 outside), "
                               "whether heights may differ on both sides.")
        .def_property_readonly("inner_lines", &inner_lines,
                               "(2, 2) float64 each: lines that the planar mesh must contain.");
    module.def("simulation_lines", &simulation_lines, py::arg("model"), py::arg("block_rock"),
               py::arg("edge_length"), py::arg("sizes"), py::arg("execution") = py::none(),
               R"(The lines of a model in plan for a mesh of columns, simplified to an edge length.

model: dict of the arrays of docs/dev/geometry.md. block_rock: (B,) int32, the rock mass of each block.
sizes: (places (N, 2) or None for all lines, length, distance): where edges are shorter. Returns PlanLines.
Raises InputError kinds "nothing", "bad_index"; Cancelled.)");
    module.def("layered_mesh", &layered_mesh, py::arg("model"), py::arg("block_rock"),
               py::arg("lines"), py::arg("vertices"), py::arg("triangles"),
               py::arg("minimum_thickness"), py::arg("layers"), py::arg("layer_thickness"),
               py::arg("divided"), py::arg("execution") = py::none(),
               R"(Columns of prisms, pyramids and tetrahedra on a planar mesh that contains `lines`.

vertices (V, 2) float64, triangles (T, 3) int32: the planar mesh. layers: of each block, how many it is
divided into (at most, where layer_thickness is above 0; 0: no limit, else one, and more where it is too
tall). divided: the elements will be divided into tetrahedra. Returns a dict: points (P, 3); tetrahedron,
pyramid, prism: dicts of corners, block, column, layer; triangle, quadrilateral: (corners, surface) of the
faces outside and between blocks; plan_vertices, plan_triangles, layers, volumes (B,), block_layers (B,);
skewed: how many faces have a skewness above 4, the largest, its place, and the blocks that are too tall.
Raises InputError kinds "bad_index", "too_large"; Cancelled.)");
    module.def("filled_mesh", &filled_mesh, py::arg("model"), py::arg("cell_region"),
               py::arg("kept"), py::arg("edge_length"), py::arg("tolerance"), py::arg("sizes"),
               py::arg("execution") = py::none(),
               R"(Each region of a model filled with tetrahedra, for models without columns.

model: dict of the arrays of docs/dev/geometry.md. cell_region: (C,) int32. kept: (S,) uint8, surfaces
whose faces matter inside a region, too. tolerance: how far boundaries may lie from the exact ones.
sizes: (places (N, 2) or None for sharp edges, length, distance): where edges are shorter, in plan.
Returns a dict: points (P, 3), tetrahedra (E, 4), region (E,), triangles (F, 3) outside, between regions
and on kept surfaces, surface (F,).
Raises InputError kinds "bad_index", "size", "too_large", "nothing", "flat", "endless"; Cancelled.)");
    module.def("clean_cells", &clean_cells, py::arg("model"), py::arg("blocks"),
               py::arg("surface_kind"), py::arg("tolerance"), py::arg("execution") = py::none(),
               R"(The cells of a model without edges, faces and cells smaller than a tolerance.

model: dict of the arrays of docs/dev/geometry.md. surface_kind: (S,) int32. Returns a dict: the same arrays,
volumes (B,), volumes_before (B,), cell_origin (C,) int32: the cell that each was; before, after: dicts of
edges, faces, cells; short_edges, thin_cells: how many had to stay; largest_move: of a vertex.
Raises InputError kind "bad_index"; Cancelled.)");
    module.def("describe_cells", &describe_cells, py::arg("face_offsets"), py::arg("face_vertices"),
               py::arg("begin"), py::arg("sides"),
               R"(Cells as VTK describes polyhedra.

begin: (C + 1,) uint32, where the sides of these cells begin and end; sides: (S,) uint32, as cell_sides has
them. Returns int64 arrays: of each cell how many faces it has, of each of these how many corners, and the
corners; the vertices of each cell, every one once, ascending; how many these are (C,), and how many numbers
of the first array describe each cell (C,). Raises InputError kind "bad_index".)");
    module.def(
        "inner_faces", &inner_faces, py::arg("face_cells"), py::arg("cells"),
        R"(The faces between two cells, by the lower of their cells and then the higher: (N,) int64.

face_cells: (F, 2) int32, the second -1 outside. Raises InputError kind "bad_index".)");
    module.def("ordered_faces", &ordered_faces, py::arg("face_offsets"), py::arg("face_vertices"),
               py::arg("face_cells"), py::arg("order"),
               R"(Faces in a new order, each seen from the lower of its cells.

face_cells: (F, 2) int32, the second -1 outside. order: (N,) int64, numbers of faces. Returns a dict: offsets
(N + 1,), vertices, owner and neighbor (N,) int32, the lower and the higher cell; turned (N,) uint8, whether
the face goes the other way round now, from the same corner on. Raises InputError kinds "bad_index",
"too_large".)");
}

}  // namespace realmodel::bindings
