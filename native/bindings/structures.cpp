// SPDX-License-Identifier: GPL-3.0-or-later
// structure_parts, build_parts, merge_cells, continued_structures, PreparedStructure,
// structure_beyond, structure_continuation.
#include "realmodel/structures/structures.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "complex_arrays.hpp"
#include "execution.hpp"
#include "realmodel/structures/build_compartments.hpp"
#include "realmodel/structures/merge_cells.hpp"
#include "rock_arrays.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// vertices, triangles, is_body, ends_at, dies_out
using StructureArrays =
    std::tuple<NumpyArray<double>, NumpyArray<std::int32_t>, bool, std::vector<std::int32_t>, bool>;

structures::Structure view_of(const StructureArrays& arrays) {
    const auto& [vertices, triangles, is_body, ends_at, dies_out] = arrays;
    require_columns(vertices, 3, "vertices of a structure");
    require_columns(triangles, 3, "triangles of a structure");
    return {{view(vertices), view(triangles)}, is_body, ends_at, dies_out};
}

std::vector<structures::Structure> views_of(const std::vector<StructureArrays>& arrays) {
    std::vector<structures::Structure> views;
    for (const StructureArrays& entry : arrays)
        views.push_back(view_of(entry));
    return views;
}

NumpyArray<std::int8_t> sides_array(const std::vector<structures::Sides>& rows,
                                    std::size_t columns) {
    NumpyArray<std::int8_t> array({rows.size(), columns});
    std::int8_t* out = array.mutable_data();
    for (const structures::Sides& row : rows)
        out = std::copy(row.begin(), row.end(), out);
    return array;
}

std::tuple<NumpyArray<std::int8_t>, NumpyArray<double>, NumpyArray<double>> structure_parts(
    const std::array<std::array<double, 3>, 2>& box, const std::vector<StructureArrays>& structures,
    WatchedExecution* execution) {
    const auto views = views_of(structures);
    auto parts = unlocked([&] { return structures::compartments_of(box, views, run(execution)); });
    std::vector<structures::Sides> sides;
    std::vector<std::array<double, 3>> low, high;
    for (const structures::Compartment& compartment : parts) {
        sides.push_back(compartment.sides);
        low.push_back(compartment.low);
        high.push_back(compartment.high);
    }
    return {sides_array(sides, views.size()), to_array(std::move(low)), to_array(std::move(high))};
}

/// triangles (K, 3, 3), is_continuation (K,), kept
using ContinuedArrays = std::tuple<NumpyArray<double>, NumpyArray<std::uint8_t>, structures::Sides>;

NumpyArray<double> corners_array(
    const std::vector<std::array<std::array<double, 3>, 3>>& triangles) {
    NumpyArray<double> array({triangles.size(), std::size_t{3}, std::size_t{3}});
    double* out = array.mutable_data();
    for (const auto& triangle : triangles) {
        for (const auto& corner : triangle)
            out = std::copy(corner.begin(), corner.end(), out);
    }
    return array;
}

structures::ContinuedStructure continued_of(const ContinuedArrays& arrays) {
    const auto& [corners, is_continuation, end_sides] = arrays;
    if (corners.size() != 9 * is_continuation.size())
        throw py::value_error("continued: nine coordinates for each triangle");
    structures::ContinuedStructure entry;
    entry.triangles.resize(static_cast<std::size_t>(is_continuation.size()));
    const double* in = corners.data();
    for (auto& triangle : entry.triangles) {
        for (auto& corner : triangle) {
            std::copy(in, in + 3, corner.begin());
            in += 3;
        }
    }
    entry.is_continuation.assign(is_continuation.data(),
                                 is_continuation.data() + is_continuation.size());
    entry.end_sides = end_sides;
    return entry;
}

std::vector<ContinuedArrays> continued_structures(const std::vector<StructureArrays>& structures,
                                                  const std::array<std::array<double, 3>, 2>& box) {
    std::vector<ContinuedArrays> arrays;
    for (auto& entry : structures::continued_structures(views_of(structures), box))
        arrays.emplace_back(corners_array(entry.triangles),
                            to_array(std::move(entry.is_continuation)), std::move(entry.end_sides));
    return arrays;
}

/// The least corner of a grid, the size of a cell, and of each cell whether it is wanted.
using WantedArrays =
    std::tuple<std::array<double, 3>, std::array<double, 3>, NumpyArray<std::uint8_t>>;

strata::WantedSpace view_of(const WantedArrays& wanted) {
    const auto& [low, step, cells] = wanted;
    if (cells.ndim() != 3 || cells.size() == 0 || cells.shape(2) > 64)
        throw py::value_error("wanted: (nx, ny, nz), with 64 layers at most");
    strata::WantedSpace space{low, step, {}, view(cells)};
    for (std::size_t axis = 0; axis < 3; ++axis)
        space.cells[axis] = static_cast<std::size_t>(cells.shape(static_cast<py::ssize_t>(axis)));
    return space;
}

/// number, block, triangles
using CompartmentSurfaceArrays =
    std::tuple<std::int32_t, std::int32_t, std::optional<NumpyArray<std::int64_t>>>;
/// stack, surfaces, emptied, fills
using CompartmentStackArrays = std::tuple<RockArrays, std::vector<CompartmentSurfaceArrays>,
                                          std::vector<std::size_t>, std::vector<std::uint8_t>>;
/// vertices, triangles, surface
using SolidArrays = std::tuple<NumpyArray<double>, NumpyArray<std::int32_t>, std::int32_t>;
/// solids; of what is between them sides and rocks
using BetweenArrays =
    std::pair<std::vector<SolidArrays>,
              std::vector<std::pair<structures::Sides, std::vector<CompartmentStackArrays>>>>;
/// sides, rocks, wanted, between solids
using CompartmentArrays = std::tuple<structures::Sides, std::vector<CompartmentStackArrays>,
                                     std::optional<WantedArrays>, std::optional<BetweenArrays>>;

structures::CompartmentStack view_of(const CompartmentStackArrays& arrays) {
    const auto& [rock, surfaces, emptied, fills] = arrays;
    structures::CompartmentStack entry{view_of(rock), {}};
    entry.stack.emptied = emptied;
    entry.stack.fills = fills;
    for (const auto& [number, block, triangles] : surfaces) {
        entry.surfaces.push_back({number, block, {}});
        if (triangles) entry.surfaces.back().triangles = view(*triangles);
    }
    return entry;
}

structures::CompartmentInput view_of(const CompartmentArrays& arrays) {
    const auto& [sides, rocks, wanted, between] = arrays;
    structures::CompartmentInput compartment{sides, {}};
    for (const CompartmentStackArrays& rock : rocks)
        compartment.rocks.push_back(view_of(rock));
    if (wanted) compartment.wanted = view_of(*wanted);
    if (!between) return compartment;
    for (const auto& [vertices, triangles, surface] : between->first) {
        require_columns(vertices, 3, "vertices of a solid");
        require_columns(triangles, 3, "triangles of a solid");
        compartment.solids.push_back({{view(vertices), view(triangles)}, surface});
    }
    for (const auto& [entry, stacks] : between->second) {
        compartment.between.push_back({entry, {}});
        for (const CompartmentStackArrays& rock : stacks)
            compartment.between.back().rocks.push_back(view_of(rock));
    }
    return compartment;
}

/// continued, largest
using PieceArrays = std::pair<std::vector<ContinuedArrays>, double>;

structures::PieceOfWhole piece_of(const PieceArrays& arrays) {
    structures::PieceOfWhole piece;
    for (const ContinuedArrays& entry : arrays.first)
        piece.continued.push_back(continued_of(entry));
    piece.largest = arrays.second;
    return piece;
}

py::dict build_parts(const std::vector<CompartmentArrays>& parts,
                     const std::pair<std::int32_t, std::vector<StructureArrays>>& structures,
                     const NumpyArray<std::uint8_t>& acts, const std::string& cells,
                     WatchedExecution* execution, const std::optional<PieceArrays>& piece) {
    if (acts.ndim() != 2) throw py::value_error("acts: (S, B)");
    structures::StructuredInput input;
    for (const CompartmentArrays& compartment : parts)
        input.compartments.push_back(view_of(compartment));
    input.surfaces = structures.first;
    input.structures = views_of(structures.second);
    input.acts = view(acts);
    input.blocks = static_cast<std::size_t>(acts.shape(1));
    input.cells = kind_of(cells);
    if (piece) input.piece = piece_of(*piece);
    auto joined = unlocked([&] {
        const MemoryRelease at_the_end;
        return structures::build_compartments(input, run(execution));
    });
    py::dict result = built_arrays(std::move(joined.complex));
    result["cell_part"] = to_array(std::move(joined.cell_compartment));
    return result;
}

py::dict merge_cells(const py::dict& complex, const Indices& number, WatchedExecution* execution) {
    ComplexArrays arrays(complex);
    arrays.complex.blocks = complex["blocks"].cast<std::size_t>();
    auto merged = unlocked([&] {
        return structures::merge_cells(arrays.complex, view(number), run(execution).progress);
    });
    return complex_arrays(merged);
}

std::unique_ptr<structures::PreparedStructure> prepared(
    const std::vector<StructureArrays>& structures) {
    const auto views = views_of(structures);
    if (views.empty()) throw py::value_error("structures: none is given");
    return std::make_unique<structures::PreparedStructure>(views);
}

NumpyArray<std::int8_t> sides_of(const structures::PreparedStructure& structure,
                                 const NumpyArray<double>& points, WatchedExecution* execution) {
    const auto at = rows<3>(points, "points");
    return to_array(unlocked([&] { return structure.sides(at, run(execution)); }));
}

NumpyArray<std::uint8_t> structure_beyond(const std::vector<StructureArrays>& faults,
                                          const NumpyArray<double>& low,
                                          const NumpyArray<double>& high,
                                          const NumpyArray<std::int32_t>& triangles,
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
    return to_array(unlocked([&] {
        return structures::triangles_beyond(views, view(low), view(high), view(triangles),
                                            run(execution));
    }));
}

NumpyArray<double> structure_continuation(const std::vector<StructureArrays>& faults,
                                          const std::array<std::array<double, 3>, 2>& box) {
    const auto views = views_of(faults);
    if (views.empty()) throw py::value_error("faults: none is given");
    return corners_array(structures::continuation_of(views, box));
}

}  // namespace

void bind_structures(py::module_& module) {
    module.def("structure_parts", &structure_parts, py::arg("box"), py::arg("structures"),
               py::arg("execution") = py::none(),
               R"(The parts that faults and bodies divide rock into.

box: two corners of a box around the rock. structures: list of (vertices (V, 3) float64, triangles (T, 3) int32, is_body, ends_at:
numbers of the faults that a fault ends at, dies_out). Returns (sides (P, S) int8: 1 above a fault or
outside of a body, -1 below or inside, 0 where there is none beyond a fault that it ends at; low
(P, 3), high (P, 3) float64: a box around each part), each combination of sides once. Raises
InputError (surface: the number of the structure) and Cancelled.)");
    module.def("build_parts", &build_parts, py::arg("parts"), py::arg("structures"),
               py::arg("acts"), py::arg("cells") = "columns", py::arg("execution") = py::none(),
               py::arg("piece") = std::nullopt,
               R"(A model with faults and bodies: the stacks of all parts of space, cut and joined.

parts: list of (sides: one a structure; rocks: one for each rock mass; wanted; between). rocks: list of (stack: as of
build_rock_masses, without surfaces where the rock mass is not there; surfaces: of each of its surfaces
(number: its own in the model, -1, -2 or -3 where there it is none but a wall, a base or a cut; block: that of the block
beneath it, -1: nothing; triangles: None, or (T,) int64, of each triangle the number in the model's surface);
emptied: the surfaces, ascending, before which all that is there becomes air, and only what was protected
stays so (no base elevation); fills: for each surface before the last of these 1 where it is the top of a
body: then what is below the oldest surface stays, but for places at which a body was there first; none:
nothing stays). wanted: None, or (low (3,), step (3,), cells (nx, ny, nz) uint8), the least corner of a grid,
the size of a cell and of each whether it is wanted: columns that lie nowhere in these may be left out (nz:
64 at most; what is above or below the grid is wanted, beside it is as in the nearest cells). between: None,
or of a part that closed surfaces divide, which then has no rocks of its own (list of (vertices (V, 3)
float64, triangles (T, 3) int32, number of the surface in the model); list of what is between them (sides: 1
outside of each, -1 inside, 0 either; rocks)): such a surface ends cells where the blocks on its two sides
differ. structures:
(how many surfaces there are, which they are counted after; list as of structure_parts). acts: (S, B) uint8,
whether a structure divides a block. cells: "columns" or "blocks". piece: None, or of a piece of a whole
model (continued: of each structure, as of continued_structures, or of some of its triangles; empty: it is
continued here; largest: the largest coordinate of the whole, which says how coarse rounding is). Returns a
dict as build_rock_masses does, and cell_part (C,) int32, the part of each cell (where cells of several
became one, the first). Raises InputError (surface: as in the model, structures counted after the surfaces)
and Cancelled.)");
    module.def("merge_cells", &merge_cells, py::arg("complex"), py::arg("number"),
               py::arg("execution") = py::none(),
               R"(A complex with some of its cells as one, and without others.

complex: dict of the arrays of docs/dev/geometry.md, and "blocks", how many there are. number: (C,) int32, of
each cell its number in the result, 0, 1, ... in the order in which they come up; -1: it is left out. A new
cell has the block of the first of its old ones. Faces within a cell and between cells that are left out go;
faces and vertices keep their order. Returns the arrays of a complex. Raises InputError and Cancelled.)");
    module.def(
        "continued_structures", &continued_structures, py::arg("structures"), py::arg("box"),
        R"(Faults and bodies with what continues them beyond their borders, as build_parts has it.

structures: as of structure_parts. box: two corners of a box around the rock. Returns of each
(triangles (K, 3, 3) float64; is_continuation (K,) uint8; kept: the side of each fault that a fault ends
at on which it is). Raises InputError.)");
    py::class_<structures::PreparedStructure>(
        module, "PreparedStructure",
        "A structure that is made ready once, and asked many times on which side points are.")
        .def(py::init(&prepared), py::arg("structures"),
             "structures: as of structure_parts, the one that is asked for, then the faults that "
             "it ends at. Raises InputError.")
        .def(
            "sides", &sides_of, py::arg("points"), py::arg("execution") = py::none(),
            R"(The side that points (N, 3) are on: (N,) int8, 1 above or outside, -1 below or inside; of a
fault by its nearest triangle. Raises InputError and Cancelled.)");
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
