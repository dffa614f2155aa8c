// SPDX-License-Identifier: GPL-3.0-or-later
// check_region.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <string>
#include <vector>

#include "execution.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/region_check.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

std::vector<NumpyArray<double>> check_region(const std::vector<NumpyArray<double>>& rings,
                                             const std::vector<std::int32_t>& polygons,
                                             const std::vector<bool>& holes,
                                             WatchedExecution* execution) {
    if (polygons.size() != rings.size() || holes.size() != rings.size()) {
        throw InputError("bad_range", "polygons and holes must be as many as there are rings");
    }
    std::vector<meshing::RegionRing> region_rings;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        const auto corners = rows<2>(rings[r], "rings");
        region_rings.push_back({{corners.begin(), corners.end()}, polygons[r], holes[r]});
    }
    auto checked =
        unlocked([&] { return meshing::checked_region(region_rings, run(execution).progress); });
    std::vector<NumpyArray<double>> arrays;
    for (meshing::Ring& ring : checked)
        arrays.push_back(to_array(std::move(ring)));
    return arrays;
}

}  // namespace

void bind_region(py::module_& module) {
    module.def("check_region", &check_region, py::arg("rings"), py::arg("polygons"),
               py::arg("holes"), py::arg("execution") = py::none(),
               R"(Checks the rings of a region, and dissolves borders that polygons share.

rings     list of (N, 2) float64, either way round
polygons  for each ring the number of the polygon that it is of
holes     for each ring whether it is said to lie inside its polygon's other ring

Returns a list of (N, 2) float64: rings that touch in points at most and count even-odd; those that
were given where no polygons share borders.

Raises InputError: kind "no_outline", "not_finite", "outline_degenerate", "outline_crosses",
"outline_overlaps", "hole_outside" (items: ring and corner numbers; place), "no_area"; Cancelled.)");
}

}  // namespace realmodel::bindings
