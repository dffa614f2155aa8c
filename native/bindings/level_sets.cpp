// SPDX-License-Identifier: GPL-3.0-or-later
// level_sets, moved_onto_levels, field_at, corners_at, points_between.
#include "realmodel/fields/level_sets.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "execution.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// A field as Python has it: (origin, spacing, counts), values, points (P, 3), values of points.
struct GivenField {
    fields::LatticeField field;

    GivenField(const py::tuple& lattice, const Array<double>& values, const Array<double>& points,
               const Array<double>& point_values) {
        if (lattice.size() != 3) throw py::value_error("lattice: origin, spacing and counts");
        field.origin = lattice[0].cast<std::array<double, 3>>();
        field.spacing = lattice[1].cast<std::array<double, 3>>();
        field.counts = lattice[2].cast<std::array<std::int32_t, 3>>();
        field.values = view(values);
        rows<3>(points, "points");
        field.points = view(points);
        field.point_values = view(point_values);
    }
};

py::list level_sets(const py::tuple& lattice, const Array<double>& values, const py::tuple& points,
                    const Array<double>& levels, WatchedExecution* execution) {
    const auto positions = points[0].cast<Array<double>>(), own = points[1].cast<Array<double>>();
    const GivenField given(lattice, values, positions, own);
    std::vector<fields::LevelSet> found;
    {
        const py::gil_scoped_release unlocked;
        found = fields::level_sets(given.field, view(levels), run(execution));
    }
    py::list sets;
    for (fields::LevelSet& each : found)
        sets.append(py::make_tuple(to_array(std::move(each.vertices)),
                                   to_array(std::move(each.triangles))));
    return sets;
}

Array<double> moved_onto_levels(const py::tuple& lattice, const Array<double>& values,
                                const Array<double>& levels) {
    const GivenField given(lattice, values, Array<double>(std::vector<py::ssize_t>{0, 3}),
                           Array<double>(0));
    return to_array(fields::moved_onto_levels(given.field, view(levels)));
}

Array<double> field_at(const py::tuple& lattice, const Array<double>& values,
                       const py::tuple& points, const Array<double>& positions,
                       WatchedExecution* execution) {
    const auto own = points[0].cast<Array<double>>(), known = points[1].cast<Array<double>>();
    const GivenField given(lattice, values, own, known);
    rows<3>(positions, "positions");
    std::vector<double> found;
    {
        const py::gil_scoped_release unlocked;
        found = fields::field_at(given.field, view(positions), run(execution));
    }
    return to_array(std::move(found));
}

py::tuple corners_at(const py::tuple& lattice, const Array<double>& values, const py::tuple& points,
                     const Array<double>& positions, WatchedExecution* execution) {
    const auto own = points[0].cast<Array<double>>(), known = points[1].cast<Array<double>>();
    const GivenField given(lattice, values, own, known);
    rows<3>(positions, "positions");
    fields::CornersAt found;
    {
        const py::gil_scoped_release unlocked;
        found = fields::corners_at(given.field, view(positions), run(execution));
    }
    return py::make_tuple(to_array(std::move(found.corners)), to_array(std::move(found.weights)));
}

Array<std::uint8_t> points_between(const py::tuple& lattice, const Array<double>& values,
                                   const py::tuple& points, WatchedExecution* execution) {
    const auto own = points[0].cast<Array<double>>(), known = points[1].cast<Array<double>>();
    const GivenField given(lattice, values, own, known);
    std::vector<std::uint8_t> found;
    {
        const py::gil_scoped_release unlocked;
        found = fields::points_between(given.field, run(execution));
    }
    return to_array(std::move(found));
}

}  // namespace

void bind_level_sets(py::module_& m) {
    m.def("level_sets", &level_sets, py::arg("lattice"), py::arg("values"), py::arg("points"),
          py::arg("levels"), py::arg("execution") = py::none(), R"doc(
The boundaries of where a field is at most each of some levels, closed around its lattice.

lattice: origin, spacing, counts. values: (N,) float64 of its nodes. points: (P, 3) float64 positions and
(P,) float64 the values that the field has there. levels: (L,) float64, ascending.
Returns a list of (vertices (V, 3) float64, triangles (T, 3) int32), seen counter-clockwise from where the
field is greater.)doc");
    m.def("moved_onto_levels", &moved_onto_levels, py::arg("lattice"), py::arg("values"),
          py::arg("levels"), R"doc(
(N,) float64: the values of a field with those that are next to nothing beside a level moved onto it.)doc");
    m.def("field_at", &field_at, py::arg("lattice"), py::arg("values"), py::arg("points"),
          py::arg("positions"), py::arg("execution") = py::none(), R"doc(
(P,) float64: a field at positions (P, 3); NaN outside of its lattice. points: as of level_sets.)doc");
    m.def("corners_at", &corners_at, py::arg("lattice"), py::arg("values"), py::arg("points"),
          py::arg("positions"), py::arg("execution") = py::none(), R"doc(
(P, 4) int64, the corners of the tetrahedra that positions (P, 3) are in: nodes, and points counted after all
nodes; (P, 4) float64, their weights, which sum to 1. points: as of level_sets.)doc");
    m.def("points_between", &points_between, py::arg("lattice"), py::arg("values"),
          py::arg("points"), py::arg("execution") = py::none(), R"doc(
(P,) uint8: of each point of a field whether it has corners with lesser and with greater values beside it. Where
not, the level set of its value does not pass through it. points: as of level_sets.)doc");
}

}  // namespace realmodel::bindings
