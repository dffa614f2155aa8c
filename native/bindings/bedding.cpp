// SPDX-License-Identifier: GPL-3.0-or-later
// bedding.
#include "realmodel/bedding/bedding.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "complex_arrays.hpp"
#include "execution.hpp"
#include "rock_arrays.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

/// (sheets, base elevation, rules).
using HistoryArrays =
    std::tuple<std::vector<SurfaceArrays>, std::optional<double>, std::vector<std::string>>;

/// faces, reversed, history and layer, of each polygon.
using PolygonArrays = std::tuple<Indices, NumpyArray<bool>, Indices, Indices>;

std::tuple<NumpyArray<float>, NumpyArray<float>, NumpyArray<float>> bedding_arrays(
    const py::dict& model, const std::vector<HistoryArrays>& history_arrays,
    const PolygonArrays& of, const Indices& histories_of_corners, WatchedExecution* execution) {
    const ComplexArrays arrays(model);
    const auto& [faces, reversed, history, layer] = of;
    std::vector<bedding::History> histories;
    for (const auto& [sheets, base_elevation, rules] : history_arrays) {
        const strata::StackInput rock = view_of(RockArrays{sheets, {}, base_elevation, rules});
        histories.push_back({rock.surfaces, rock.rules, rock.base_elevation});
    }
    const auto count = static_cast<std::size_t>(faces.size());
    if (reversed.size() != faces.size() || history.size() != faces.size() ||
        layer.size() != faces.size()) {
        throw py::value_error("faces, reversed, history, layer: one for each polygon");
    }
    std::vector<bedding::BedPolygon> polygons(count);
    for (std::size_t n = 0; n < count; ++n) {
        polygons[n] = {faces.data()[n], reversed.data()[n], history.data()[n], layer.data()[n]};
    }
    auto made = unlocked([&] {
        return bedding::bedding_of(arrays.complex, histories, polygons, view(histories_of_corners),
                                   run(execution));
    });
    return {to_array(std::move(made.height)), to_array(std::move(made.thickness)),
            to_array(std::move(made.depth))};
}

}  // namespace

void bind_bedding(py::module_& module) {
    module.def("bedding", &bedding_arrays, py::arg("model"), py::arg("histories"),
               py::arg("polygons"), py::arg("histories_of_corners"),
               py::arg("execution") = py::none(),
               R"(Where the corners of polygons lie in their layers as they were deposited.

model: the arrays of docs/dev/geometry.md. histories: (sheets, base elevation or None, rules) of each rock
mass or compartment, sheets as (vertices (V, 3), triangles (T, 3)), oldest first. polygons, of each: faces (N,)
int32; reversed (N,) bool, seen from its second cell; history (N,) int32; layer (N,) int32, the sheet that its
block lies beneath, -1: none. histories_of_corners: of each corner in place of its polygon's, or empty.

Returns of each corner, in the order that the polygon's side has, (C,) float32: height in the layer from 0 to
1, thickness of the layer as it was deposited, depth below the youngest top. The same for any number of
threads. Raises InputError kind "bad_index", "too_large"; Cancelled.)");
}

}  // namespace realmodel::bindings
