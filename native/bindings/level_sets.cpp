// SPDX-License-Identifier: GPL-3.0-or-later
// level_sets, moved_onto_levels, field_at, tetrahedra_at, points_between, values_through,
// without_critical_points.
#include "realmodel/fields/level_sets.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "arrays.hpp"
#include "execution.hpp"
#include "lattice.hpp"
#include "realmodel/fields/critical_points.hpp"
#include "realmodel/fields/values_through.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// Positions (P, 3), and the values there.
using PointsTuple = std::tuple<NumpyArray<double>, NumpyArray<double>>;

fields::LatticeField field_of(const LatticeTuple& lattice, const NumpyArray<double>& values,
                              const PointsTuple& points) {
    const auto& [positions, on_sides] = points;
    require_columns(positions, 3, "points");
    return {lattice_of(lattice), view(values), view(positions), view(on_sides)};
}

py::list level_sets(const LatticeTuple& lattice, const NumpyArray<double>& values,
                    const PointsTuple& points, const NumpyArray<double>& levels,
                    WatchedExecution* execution) {
    const fields::LatticeField field = field_of(lattice, values, points);
    auto result = unlocked([&] { return fields::level_sets(field, view(levels), run(execution)); });
    py::list sets;
    for (fields::LevelSet& set : result)
        sets.append(py::make_tuple(to_array(std::move(set.vertices)),
                                   to_array(std::move(set.triangles)), set.on_level));
    return sets;
}

NumpyArray<double> moved_onto_levels(const LatticeTuple& lattice, const NumpyArray<double>& values,
                                     const NumpyArray<double>& levels) {
    const fields::LatticeField field{lattice_of(lattice), view(values), {}, {}};
    return to_array(fields::moved_onto_levels(field, view(levels)));
}

NumpyArray<double> field_at(const LatticeTuple& lattice, const NumpyArray<double>& values,
                            const PointsTuple& points, const NumpyArray<double>& positions,
                            WatchedExecution* execution) {
    const fields::LatticeField field = field_of(lattice, values, points);
    require_columns(positions, 3, "positions");
    return to_array(
        unlocked([&] { return fields::field_at(field, view(positions), run(execution)); }));
}

py::tuple tetrahedra_at(const LatticeTuple& lattice, const NumpyArray<double>& values,
                        const PointsTuple& points, const NumpyArray<double>& positions,
                        WatchedExecution* execution) {
    const fields::LatticeField field = field_of(lattice, values, points);
    require_columns(positions, 3, "positions");
    auto result =
        unlocked([&] { return fields::tetrahedra_at(field, view(positions), run(execution)); });
    return py::make_tuple(to_array(std::move(result.corners)), to_array(std::move(result.weights)));
}

NumpyArray<std::uint8_t> points_between(const LatticeTuple& lattice,
                                        const NumpyArray<double>& values, const PointsTuple& points,
                                        WatchedExecution* execution) {
    const fields::LatticeField field = field_of(lattice, values, points);
    return to_array(unlocked([&] { return fields::points_between(field, run(execution)); }));
}

py::tuple values_through(const NumpyArray<double>& start_values,
                         const NumpyArray<std::int64_t>& corners, const NumpyArray<double>& weights,
                         const NumpyArray<double>& levels, int rounds,
                         WatchedExecution* execution) {
    const fields::LevelsAtContacts at{rows<4>(corners, "corners"), rows<4>(weights, "weights"),
                                      view(levels)};
    auto result = unlocked(
        [&] { return fields::values_through(view(start_values), at, rounds, run(execution)); });
    return py::make_tuple(to_array(std::move(result.values)), to_array(std::move(result.missed)));
}

py::tuple without_critical_points(
    const LatticeTuple& lattice, const NumpyArray<double>& values, const PointsTuple& points,
    const NumpyArray<std::uint8_t>& fixed,
    const std::tuple<NumpyArray<double>, NumpyArray<double>>& dips_and_normals,
    const std::tuple<NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>& of_bounds,
    WatchedExecution* execution) {
    const fields::LatticeField field = field_of(lattice, values, points);
    const auto& [dips, normals] = dips_and_normals;
    const auto& [bounds, signs, levels] = of_bounds;
    const fields::HeldData held{
        view(fixed), rows<3>(dips, "dips"), rows<3>(normals, "normals"), rows<3>(bounds, "bounds"),
        view(signs), view(levels)};
    auto result =
        unlocked([&] { return fields::without_critical_points(field, held, run(execution)); });
    return py::make_tuple(to_array(std::move(result.values)),
                          to_array(std::move(result.point_values)),
                          to_array(std::move(result.critical)));
}

}  // namespace

void bind_level_sets(py::module_& m) {
    m.def("level_sets", &level_sets, py::arg("lattice"), py::arg("values"), py::arg("points"),
          py::arg("levels"), py::arg("execution") = py::none(), R"doc(
The boundaries of where a field is at most each of some levels, closed beyond the sides of its lattice.

lattice: origin, spacing, counts. values: (N,) float64 of its nodes. points: (P, 3) float64 positions and
(P,) float64 the values that the field has there. levels: (L,) float64, ascending.
Returns a list of (vertices (V, 3) float64, triangles (T, 3) int32, how many of these are the level set itself),
which are seen counter-clockwise from where the field is greater.)doc");
    m.def("moved_onto_levels", &moved_onto_levels, py::arg("lattice"), py::arg("values"),
          py::arg("levels"), R"doc(
(N,) float64: the values of a field with those that are next to nothing beside a level moved onto it.)doc");
    m.def("field_at", &field_at, py::arg("lattice"), py::arg("values"), py::arg("points"),
          py::arg("positions"), py::arg("execution") = py::none(), R"doc(
(P,) float64: a field at positions (P, 3); NaN outside of its lattice. points: as of level_sets.)doc");
    m.def("tetrahedra_at", &tetrahedra_at, py::arg("lattice"), py::arg("values"), py::arg("points"),
          py::arg("positions"), py::arg("execution") = py::none(), R"doc(
(P, 4) int64, the corners of the tetrahedra that positions (P, 3) are in: nodes, and points counted after all
nodes; (P, 4) float64, their weights, which sum to 1. points: as of level_sets.)doc");
    m.def("points_between", &points_between, py::arg("lattice"), py::arg("values"),
          py::arg("points"), py::arg("execution") = py::none(), R"doc(
(P,) uint8: of each point of a field whether it has corners with lesser and with greater values beside it. Where
not, the level set of its value does not pass through it. points: as of level_sets.)doc");
    m.def("without_critical_points", &without_critical_points, py::arg("lattice"),
          py::arg("values"), py::arg("points"), py::arg("fixed"), py::arg("dips"),
          py::arg("bounds"), py::arg("execution") = py::none(), R"doc(
(N,) and (P,) float64: the values of the nodes and the points of a field, moved as little as they must be for it to
have as few critical points as its data allow; (C, 3) float64: where it has some still. fixed: (N + P,) uint8, those
not to be moved. dips: positions (D, 3) and normals (D, 3), along which it goes on rising. bounds: positions (B, 3),
signs (B,) and levels (B,): where it goes on being above, with sign 1, or below these. points: as of level_sets.)doc");
    m.def("values_through", &values_through, py::arg("given"), py::arg("corners"),
          py::arg("weights"), py::arg("levels"), py::arg("rounds"),
          py::arg("execution") = py::none(), R"doc(
(N,) float64: values near those given with which a field has levels (C,) at contacts, as far as these do not pull
at the same corners; (C,) float64: what it still misses them by, less in each round. corners: (C, 4) int64, of
the tetrahedra of contacts, by their places among the values; weights: (C, 4) float64, of these.)doc");
}

}  // namespace realmodel::bindings
