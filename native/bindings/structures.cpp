// SPDX-License-Identifier: GPL-3.0-or-later
// structure_parts, join_structured, structure_sides.
#include "realmodel/structures/structures.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "complex_arrays.hpp"
#include "execution.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// vertices, triangles, is_body, ends_at, dies_out
using StructureArrays =
    std::tuple<Array<double>, Array<std::int32_t>, bool, std::vector<std::int32_t>, bool>;

structures::Structure view_of(const StructureArrays& arrays) {
    const auto& [vertices, triangles, is_body, ends_at, dies_out] = arrays;
    require_columns(vertices, 3, "vertices of a structure");
    require_columns(triangles, 3, "triangles of a structure");
    return {{{vertices.data(), static_cast<std::size_t>(vertices.size())},
             {triangles.data(), static_cast<std::size_t>(triangles.size())}},
            is_body,
            ends_at,
            dies_out};
}

std::vector<structures::Structure> views_of(const std::vector<StructureArrays>& arrays) {
    std::vector<structures::Structure> views;
    for (const StructureArrays& own : arrays)
        views.push_back(view_of(own));
    return views;
}

struct PartArrays : ComplexArrays {
    explicit PartArrays(const py::dict& arrays) : ComplexArrays(arrays) {
        complex.blocks = arrays["blocks"].cast<std::size_t>();
        complex.surfaces = arrays["surfaces"].cast<std::int32_t>();
        if (arrays["cell_kind"].cast<std::string>() == "blocks")
            complex.cell_kind = CellKind::kBlocks;
    }
};

Array<std::int8_t> sides_array(const std::vector<structures::Sides>& rows, std::size_t columns) {
    Array<std::int8_t> array({rows.size(), columns});
    std::int8_t* out = array.mutable_data();
    for (const structures::Sides& row : rows)
        out = std::copy(row.begin(), row.end(), out);
    return array;
}

std::tuple<Array<std::int8_t>, Array<double>, Array<double>> structure_parts(
    const py::dict& rock, const std::vector<StructureArrays>& structures,
    WatchedExecution* execution) {
    const PartArrays arrays(rock);
    const auto views = views_of(structures);
    std::vector<structures::Part> parts;
    {
        const py::gil_scoped_release release;
        parts = structures::parts_of(arrays.complex, views, run(execution));
    }
    std::vector<structures::Sides> sides;
    std::vector<std::array<double, 3>> low, high;
    for (const structures::Part& part : parts) {
        sides.push_back(part.sides);
        low.push_back(part.low);
        high.push_back(part.high);
    }
    return {sides_array(sides, views.size()), to_array(std::move(low)), to_array(std::move(high))};
}

/// triangles (K, 3, 3), is_continuation (K,), kept
using ContinuedArrays = std::tuple<Array<double>, Array<std::uint8_t>, structures::Sides>;

Array<double> corners_array(const std::vector<std::array<std::array<double, 3>, 3>>& triangles) {
    Array<double> array({triangles.size(), std::size_t{3}, std::size_t{3}});
    double* out = array.mutable_data();
    for (const auto& triangle : triangles) {
        for (const auto& corner : triangle)
            out = std::copy(corner.begin(), corner.end(), out);
    }
    return array;
}

structures::ContinuedStructure continued_of(const ContinuedArrays& arrays) {
    const auto& [corners, is_continuation, kept] = arrays;
    if (corners.size() != 9 * is_continuation.size())
        throw py::value_error("continued: nine coordinates for each triangle");
    structures::ContinuedStructure own;
    own.triangles.resize(static_cast<std::size_t>(is_continuation.size()));
    const double* in = corners.data();
    for (auto& triangle : own.triangles) {
        for (auto& corner : triangle) {
            std::copy(in, in + 3, corner.begin());
            in += 3;
        }
    }
    own.is_continuation.assign(is_continuation.data(),
                               is_continuation.data() + is_continuation.size());
    own.kept = kept;
    return own;
}

std::vector<ContinuedArrays> continued_structures(const std::vector<StructureArrays>& structures,
                                                  const std::array<std::array<double, 3>, 2>& box) {
    std::vector<ContinuedArrays> arrays;
    for (auto& own : structures::continued_structures(views_of(structures), box))
        arrays.emplace_back(corners_array(own.triangles), to_array(std::move(own.is_continuation)),
                            std::move(own.kept));
    return arrays;
}

py::dict join_structured(const std::vector<std::pair<py::dict, structures::Sides>>& models,
                         const std::vector<StructureArrays>& structures,
                         const Array<std::uint8_t>& acts, WatchedExecution* execution,
                         const std::vector<ContinuedArrays>& continued, double largest) {
    std::vector<PartArrays> arrays;
    for (const auto& [model, sides] : models)
        arrays.emplace_back(model);
    std::vector<structures::PartModel> parts;
    for (std::size_t m = 0; m < models.size(); ++m) {
        if (models[m].second.size() != structures.size())
            throw py::value_error("sides: one for each structure");
        parts.push_back({arrays[m].complex, models[m].second});
    }
    const auto views = views_of(structures);
    std::vector<structures::ContinuedStructure> beyond;
    for (const ContinuedArrays& own : continued)
        beyond.push_back(continued_of(own));
    if (!beyond.empty() && beyond.size() != views.size())
        throw py::value_error("continued: one for each structure");
    structures::Joined joined;
    {
        const py::gil_scoped_release release;
        joined = structures::join_models(parts, views,
                                         {acts.data(), static_cast<std::size_t>(acts.size())},
                                         run(execution), beyond, largest);
    }
    py::dict result = complex_arrays(joined.complex);
    result["cell_part"] = to_array(std::move(joined.cell_part));
    return result;
}

Array<std::int8_t> structure_sides(const std::vector<StructureArrays>& structures,
                                   const Array<double>& points, WatchedExecution* execution) {
    require_columns(points, 3, "points");
    const auto views = views_of(structures);
    if (views.empty()) throw py::value_error("structures: none is given");
    std::vector<std::int8_t> sides;
    {
        const py::gil_scoped_release release;
        sides = structures::sides_of_points(
            views, {points.data(), static_cast<std::size_t>(points.size())}, run(execution));
    }
    return to_array(std::move(sides));
}

Array<std::uint8_t> structure_beyond(const std::vector<StructureArrays>& faults,
                                     const Array<double>& low, const Array<double>& high,
                                     const Array<std::int32_t>& triangles,
                                     WatchedExecution* execution) {
    require_columns(low, 3, "low");
    require_columns(high, 3, "high");
    require_columns(triangles, 3, "triangles");
    if (low.shape(0) != high.shape(0)) throw py::value_error("low and high: one of each vertex");
    for (py::ssize_t i = 0; i < triangles.size(); ++i) {
        if (triangles.data()[i] < 0 || triangles.data()[i] >= low.shape(0))
            throw py::value_error("triangles: a vertex that is not there");
    }
    const auto views = views_of(faults);
    if (views.empty()) throw py::value_error("faults: none is given");
    std::vector<std::uint8_t> found;
    {
        const py::gil_scoped_release release;
        found = structures::triangles_beyond(
            views, {low.data(), static_cast<std::size_t>(low.size())},
            {high.data(), static_cast<std::size_t>(high.size())},
            {triangles.data(), static_cast<std::size_t>(triangles.size())}, run(execution));
    }
    return to_array(std::move(found));
}

Array<double> structure_continuation(const std::vector<StructureArrays>& faults,
                                     const std::array<std::array<double, 3>, 2>& box) {
    const auto views = views_of(faults);
    if (views.empty()) throw py::value_error("faults: none is given");
    return corners_array(structures::continuation_of(views, box));
}

}  // namespace

void bind_structures(py::module_& module) {
    module.def("structure_parts", &structure_parts, py::arg("rock"), py::arg("structures"),
               py::arg("execution") = py::none(),
               R"(The parts that faults and bodies divide rock into.

rock: dict of the arrays of docs/dev/geometry.md, "blocks" and "surfaces" (their numbers) and
"cell_kind". structures: list of (vertices (V, 3) float64, triangles (T, 3) int32, is_body, ends_at:
numbers of the faults that a fault ends at, dies_out). Returns (sides (P, S) int8: 1 above a fault or
outside of a body, -1 below or inside, 0 where there is none beyond a fault that it ends at; low
(P, 3), high (P, 3) float64: a box around each part), each combination of sides once. Raises
InputError (surface: the number of the structure) and Cancelled.)");
    module.def("join_structured", &join_structured, py::arg("models"), py::arg("structures"),
               py::arg("acts"), py::arg("execution") = py::none(),
               py::arg("continued") = std::vector<ContinuedArrays>(), py::arg("largest") = 0.0,
               R"(Models of the parts that faults and bodies leave, cut by them and joined.

models: list of (dict as of structure_parts, sides: one a structure; 0: either). structures: as of
structure_parts. acts: (S, B) uint8, whether a structure divides a block. continued: of each structure,
as of continued_structures, or of some of its triangles; empty: it is continued here. largest: the largest
coordinate of the whole that these models are a piece of, which says how coarse rounding is; 0: theirs
says. Returns the arrays of a complex, face_surface counting structures after the surfaces; volumes (B,); cell_part (C,) int32, the
model of each cell (where cells of several became one, the first). Raises InputError and Cancelled.)");
    module.def(
        "continued_structures", &continued_structures, py::arg("structures"), py::arg("box"),
        R"(Faults and bodies with what continues them beyond their borders, as join_structured has it.

structures: as of structure_parts. box: two corners of a box around the rock. Returns of each
(triangles (K, 3, 3) float64; is_continuation (K,) uint8; kept: the side of each fault that a fault ends
at on which it is). Raises InputError.)");
    module.def(
        "structure_sides", &structure_sides, py::arg("structures"), py::arg("points"),
        py::arg("execution") = py::none(),
        R"(The side of a structure that points (N, 3) are on: (N,) int8, 1 above or outside, -1
below or inside; of a fault by its nearest triangle.

structures: as of structure_parts, the one that is asked for, then the faults that it ends at. Raises
InputError and Cancelled.)");
    module.def("structure_beyond", &structure_beyond, py::arg("faults"), py::arg("low"),
               py::arg("high"), py::arg("triangles"), py::arg("execution") = py::none(),
               R"(Which triangles of a sheet a fault meets where it goes on beyond its border.

faults: as of structure_parts, the one that is asked for, then those that it ends at. low, high: (N, 3) float64, the lowest and the highest place of each
vertex, equal in plan. triangles: (T, 3) int32. Returns (T,) uint8, 1 where it may touch a triangle,
2 where it may pass it: none too few, perhaps some too many. Raises InputError and Cancelled.)");
    module.def("structure_continuation", &structure_continuation, py::arg("faults"), py::arg("box"),
               R"(The triangles (K, 3, 3) float64 by which a fault goes on beyond its border.

faults: as of structure_parts, the one that is asked for, then those that it ends at. box: two corners of a box around the rock, which they leave. Raises
InputError.)");
}

}  // namespace realmodel::bindings
