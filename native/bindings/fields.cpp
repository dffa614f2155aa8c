// SPDX-License-Identifier: GPL-3.0-or-later
// solve_field, critical_points.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "execution.hpp"
#include "lattice.hpp"
#include "realmodel/fields/critical_points.hpp"
#include "realmodel/fields/field.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// How many surfaces; positions, and the surface of each.
using ContactsTuple = std::tuple<int, NumpyArray<double>, Indices, double>;
using DipsAndNormals = std::tuple<NumpyArray<double>, NumpyArray<double>>;
/// Positions, the surface below each and above it.
using BoundsTuple = std::tuple<NumpyArray<double>, Indices, Indices>;
/// Axes and ratios.
using AnisotropyTuple = std::tuple<std::array<std::array<double, 3>, 3>, std::array<double, 3>>;
/// How many faults part the field, combinations of sides; further coordinates of contacts, dips and
/// bounds, how they rise at dips; normals of the faults; those of nodes, the nodes that are the
/// same, the sides of bounds.
using SlitsTuple = std::tuple<std::size_t, std::size_t, NumpyArray<double>, NumpyArray<double>,
                              NumpyArray<double>, NumpyArray<double>, NumpyArray<double>,
                              NumpyArray<double>, NumpyArray<std::int64_t>, Indices>;
/// Tolerance, most centers, whether beds keep their thickness.
using OptionsTuple = std::tuple<double, int, std::optional<bool>>;
/// Axes and ratios, order, errors of values and of slopes, lift, throws, scale; gaps, centers, left
/// out; how it rises at places where beds keep their thickness, and the error of this.
using KindTuple =
    std::tuple<AnisotropyTuple, int, double, double, double, std::vector<std::array<double, 3>>,
               double, std::vector<double>, std::vector<std::uint8_t>, std::vector<std::uint8_t>,
               std::vector<std::array<double, 3>>, double>;
/// A kind; numbers of directions, of steps and of errors of dips.
using DrawTuple = std::tuple<KindTuple, NumpyArray<double>, NumpyArray<double>, NumpyArray<double>>;

KindTuple tuple_of(const fields::FunctionKind& kind) {
    return {{kind.anisotropy.axes, kind.anisotropy.ratios},
            kind.order,
            kind.value_error,
            kind.slope_error,
            kind.lift,
            kind.throws,
            kind.scale,
            kind.gaps,
            kind.centers,
            kind.left_out,
            kind.even,
            kind.even_error};
}

/// Of each bound the kind and the row of each datum.
std::vector<std::vector<std::pair<std::string, std::int64_t>>> listed(
    const std::vector<std::vector<fields::Datum>>& data) {
    std::vector<std::vector<std::pair<std::string, std::int64_t>>> out;
    for (const std::vector<fields::Datum>& of_bound : data) {
        out.emplace_back();
        for (const auto& [kind, row] : of_bound) {
            out.back().emplace_back(kind == fields::Datum::Kind::kContact ? "contact"
                                    : kind == fields::Datum::Kind::kDip   ? "dip"
                                                                          : "bound",
                                    row);
        }
    }
    return out;
}

fields::FieldDraw draw_of(const DrawTuple& draw_tuple, std::size_t slits) {
    const auto& [kind, directions, steps, errors] = draw_tuple;
    const auto& [anisotropy, order, value, slope, lift, throws, scale, gaps, centers, left_out,
                 even, even_error] = kind;
    return {{std::make_from_tuple<fields::AxisRatios>(anisotropy), order, value, slope, lift,
             throws, scale, gaps, centers, left_out, even, even_error},
            {3 + slits, view(directions), view(steps), view(errors)}};
}

py::dict solve(const LatticeTuple& lattice, const ContactsTuple& contacts,
               const DipsAndNormals& dips, const BoundsTuple& bounds,
               const OptionsTuple& option_tuple, const std::optional<SlitsTuple>& slits,
               const std::optional<DrawTuple>& drawn, WatchedExecution* execution) {
    fields::FieldData data;
    data.surfaces = std::get<0>(contacts);
    data.contacts = rows<3>(std::get<1>(contacts), "contacts");
    data.contact_surfaces = view(std::get<2>(contacts));
    data.error = std::get<3>(contacts);
    data.dips = rows<3>(std::get<0>(dips), "dips");
    data.normals = rows<3>(std::get<1>(dips), "normals");
    data.bounds = rows<3>(std::get<0>(bounds), "bounds");
    data.bound_below = view(std::get<1>(bounds));
    data.bound_above = view(std::get<2>(bounds));
    if (slits) {
        const auto& [count, sides, of_contacts, of_dips, of_bounds, slopes, normals, nodes, same,
                     of_bound] = *slits;
        data.slits = {count,           view(of_contacts), view(of_dips),
                      view(of_bounds), view(slopes),      rows<3>(normals, "normals"),
                      sides,           view(nodes),       view(same),
                      view(of_bound)};
    }
    const auto& [tolerance, most_centers, is_even] = option_tuple;
    std::optional<fields::FieldDraw> draw;
    if (drawn) draw = draw_of(*drawn, data.slits.count);
    const fields::FieldOptions options{tolerance, most_centers, draw ? &*draw : nullptr, is_even};
    auto made = unlocked(
        [&] { return fields::solve_field(lattice_of(lattice), data, options, run(execution)); });
    py::dict out;
    out["values"] = to_array(std::move(made.values));
    out["levels"] = to_array(std::move(made.levels));
    out["contradicted"] = listed(made.contradicted);
    out["kind"] = tuple_of(made.kind);
    out["centers"] = made.centers;
    out["misfit"] = made.misfit;
    out["dips_missed"] = to_array(std::move(made.dips_missed));
    out["bounds_missed"] = to_array(std::move(made.bounds_missed));
    out["plain_shares"] = to_array(std::move(made.plain_shares));
    return out;
}

std::pair<NumpyArray<std::int64_t>, std::vector<std::string>> critical(
    const LatticeTuple& lattice, const NumpyArray<double>& values, WatchedExecution* execution) {
    auto points = unlocked(
        [&] { return fields::critical_points(lattice_of(lattice), view(values), run(execution)); });
    std::vector<std::int64_t> nodes;
    std::vector<std::string> kinds;
    for (const fields::CriticalPoint& point : points) {
        nodes.push_back(point.node);
        kinds.emplace_back(point.kind == fields::CriticalKind::kMinimum   ? "minimum"
                           : point.kind == fields::CriticalKind::kMaximum ? "maximum"
                                                                          : "saddle");
    }
    return {to_array(std::move(nodes)), kinds};
}

}  // namespace

void bind_fields(py::module_& module) {
    module.def("solve_field", &solve, py::arg("lattice"), py::arg("contacts"), py::arg("dips"),
               py::arg("bounds"), py::arg("options"), py::arg("slits") = py::none(),
               py::arg("draw") = py::none(), py::arg("execution") = py::none(),
               R"(The smoothest field in space that honors the data, and the level of each surface.

lattice: (origin, spacing, counts). contacts: how many surfaces there are, positions (N, 3), the surface of each (N,),
0 the oldest, and how far they may be off, as a standard deviation. dips: positions (M, 3) and normals of length 1
toward younger rock (M, 3). bounds: positions (B, 3), the surface below each and above it (B,), -1: none. options: the
distance by which surfaces may miss contacts; at most how many contacts carry the field; whether beds keep their
thickness, None: if this predicts data better that are left out. slits: of faults that part
the field how many, and the combinations of their sides; the further coordinates that these give contacts (N, F),
dips (M, F), bounds (B, F), how they rise at dips (M, F, 3); normals of the faults (F, 3), of length 1; those of nodes
(S, nodes, F) on each combination, the first of these S * nodes that each is the same as (S * nodes,), and the
combination of each bound (B,). draw: None, or of a field that is drawn at random its kind, as it is returned of the
same data, and normal numbers: (lines, 3 + F), (lines, steps), and 2 M for dips with one for each row of the kind's
directions.
Returns a dict: values (S * nodes,), levels (surfaces,), centers, misfit, dips_missed, bounds_missed; contradicted, of
each of these bounds the data that it contradicts, as ("contact", "dip" or "bound", row); kind, of the random function:
(axes, ratios), order, errors of values and of slopes, scale of further coordinates, throws of the faults, in units of
half of the lattice's diagonal, variance, gaps, centers, inequalities that are left out, directions at places where beds keep their thickness (none:
they do not) and the error of these; plain_shares, of the lattice for
each block with the best field that has no ranges and no anisotropy, none if it is this or predicts data clearly worse.
Raises InputError.)");
    module.def(
        "critical_points", &critical, py::arg("lattice"), py::arg("values"),
        py::arg("execution") = py::none(),
        R"(The inner nodes at which a field that is linear on the lattice's tetrahedra has a critical point.

lattice: (origin, spacing, counts). values: (nodes,). Returns the nodes (C,) int64 and for each "minimum", "saddle"
or "maximum".)");
}

}  // namespace realmodel::bindings
