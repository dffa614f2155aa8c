// SPDX-License-Identifier: GPL-3.0-or-later
// check_topology, check_samples and cells_at.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "arrays.hpp"
#include "complex_arrays.hpp"
#include "execution.hpp"
#include "realmodel/validation/cells_at.hpp"
#include "realmodel/validation/sampling.hpp"
#include "realmodel/validation/topology.hpp"
#include "rock_arrays.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

py::list to_list(const std::vector<validation::TestResult>& results) {
    py::list list;
    for (const validation::TestResult& test : results) {
        py::list offenders;
        for (const validation::Offender& o : test.findings.first) {
            py::dict entry;
            entry["text"] = o.text;
            entry["cell"] = o.cell;
            entry["face"] = o.face;
            entry["vertex"] = o.vertex;
            entry["block"] = o.block;
            entry["place"] =
                o.place ? py::object(py::make_tuple((*o.place)[0], (*o.place)[1], (*o.place)[2]))
                        : py::object(py::none());
            offenders.append(entry);
        }
        py::dict entry;
        entry["name"] = test.name;
        entry["unit"] = test.unit;
        entry["examined"] = test.findings.examined;
        entry["failed"] = test.findings.failed;
        entry["undecided"] = test.findings.undecided;
        entry["offenders"] = offenders;
        entry["seconds"] = test.seconds;
        list.append(entry);
    }
    return list;
}

struct ValidatedModel : ComplexArrays {
    NumpyArray<double> block_volume, block_base;

    explicit ValidatedModel(const py::dict& model) : ComplexArrays(model) {
        take(model, "block_volume", block_volume, complex.block_volume);
        take(model, "block_base", block_base, complex.block_base);
        complex.blocks = complex.block_volume.size();
        complex.surfaces = model["surfaces"].cast<std::int32_t>();
        if (model["cells_are_blocks"].cast<bool>()) complex.cell_kind = CellKind::kBlocks;
    }
};

py::list check_topology(const py::dict& model, WatchedExecution* execution) {
    const ValidatedModel arrays(model);
    return to_list(
        unlocked([&] { return validation::check_topology(arrays.complex, run(execution)); }));
}

py::list check_samples(const py::dict& model, const std::vector<RockArrays>& rocks,
                       const Indices& block_of_surface, std::int64_t places, std::uint64_t seed,
                       WatchedExecution* execution) {
    const ValidatedModel arrays(model);
    std::vector<strata::StackInput> input;
    std::size_t surfaces = 0;
    for (const RockArrays& rock : rocks) {
        input.push_back(view_of(rock));
        surfaces += input.back().surfaces.size();
    }
    const auto block = view(block_of_surface);
    if (block.size() != surfaces || surfaces != static_cast<std::size_t>(arrays.complex.surfaces)) {
        throw py::value_error("block_of_surface: one for each surface of the rocks");
    }
    return to_list(unlocked([&] {
        return validation::check_samples(arrays.complex, {input, block}, places, seed,
                                         run(execution));
    }));
}

NumpyArray<std::int32_t> cells_at(const py::dict& model, const NumpyArray<double>& positions,
                                  WatchedExecution* execution) {
    const ComplexArrays arrays(model);
    const auto at = rows<3>(positions, "positions");
    return to_array(
        unlocked([&] { return validation::cells_at(arrays.complex, at, run(execution)); }));
}

}  // namespace

void bind_validation(py::module_& module) {
    module.def("check_topology", &check_topology, py::arg("model"),
               py::arg("execution") = py::none(),
               R"(Every test of cells that needs nothing but the cells, of all of them.

model: dict of vertices (V, 3) float64, face_offsets (F + 1,) int64, face_vertices int32, face_cells
(F, 2) int32, face_surface (F,) int32, cell_block (C,) int32, block_volume (B,) float64, block_base
(B,) float64 (height of the base that a block stands on, NaN: none), surfaces int, cells_are_blocks
bool. Returns a list of tests, each a dict of name, unit, examined, failed, undecided, offenders
(list of dicts: text, cell, face, vertex, block, place), seconds. Raises Cancelled.)");
    module.def("check_samples", &check_samples, py::arg("model"), py::arg("rocks"),
               py::arg("block_of_surface"), py::arg("places"), py::arg("seed") = 1,
               py::arg("execution") = py::none(),
               R"(Compares a model with the closed form of what it was built from, at plan places.

model as for check_topology, which it must have passed so far that its arrays fit together; rocks as for
build_rock_masses; block_of_surface (S,) int32: the block beneath each surface, -1: none; places: about how
many; seed: which. Returns tests like check_topology. Raises Cancelled, and InputError where a triangle names
a vertex that does not exist.)");
    module.def(
        "cells_at", &cells_at, py::arg("model"), py::arg("positions"),
        py::arg("execution") = py::none(),
        R"(The cell (N,) int32 of a model that each position (N, 3) lies in, -1 for none; exact.

model: its arrays as for check_topology, which it must have passed. A position on a face is above it. Raises
Cancelled.)");
}

}  // namespace realmodel::bindings
