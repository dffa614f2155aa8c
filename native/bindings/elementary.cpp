// SPDX-License-Identifier: GPL-3.0-or-later
// sin, cos, atan2, exp, hypot: NumPy's give other last digits on other systems and processors.
#include "realmodel/base/elementary.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace py = pybind11;

namespace realmodel::bindings {

void bind_elementary(py::module_& module) {
    const char* doc = "Of numbers or arrays, the same bytes on every system.";
    module.def("sin", py::vectorize(elementary::sin), py::arg("x"), doc);
    module.def("cos", py::vectorize(elementary::cos), py::arg("x"), doc);
    module.def("exp", py::vectorize(elementary::exp), py::arg("x"), doc);
    module.def("atan2", py::vectorize(elementary::atan2), py::arg("y"), py::arg("x"), doc);
    module.def("hypot", py::vectorize(elementary::hypot), py::arg("x"), py::arg("y"), doc);
}

}  // namespace realmodel::bindings
