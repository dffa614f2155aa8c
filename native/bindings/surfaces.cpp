// SPDX-License-Identifier: GPL-3.0-or-later
// outside_hull.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <utility>

#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/convex_hull.hpp"
#include "rows.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

py::array outside_hull(const Array<double>& points, const Array<double>& nodes, int threads,
                       Progress* control) {
    const auto from = rows<3>(points, "points");
    const auto to = rows<2>(nodes, "nodes");
    std::vector<std::uint8_t> outside;
    {
        const py::gil_scoped_release unlocked;
        outside = interpolation::outside_hull(from, to, threads, control);
    }
    return to_array(std::move(outside)).attr("view")("bool");
}

}  // namespace

void bind_surfaces(py::module_& module) {
    using py::arg;
    module.def("outside_hull", &outside_hull, arg("points"), arg("nodes"), arg("threads") = 0,
               arg("control") = py::none(),
               R"(The nodes (N, 2) outside the convex hull of points (P, 3) in plan: (N,) bool.)");
}

}  // namespace realmodel::bindings
