// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module realmodel._native: thin, NumPy arrays in and out. Every other file NAME.cpp of
// this folder defines realmodel::bindings::bind_NAME(module) and is found by CMake.
#include <pybind11/pybind11.h>

#include <string>

#include "bind_parts.hpp"

namespace py = pybind11;

namespace {

/// An older pybind11 takes NumPy 2's arrays for NumPy 1's: numbers would come out wrong, without
/// any error.
void refuse_unknown_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
    const std::string version = py::str(py::module_::import("numpy").attr("__version__"));
    if (version.rfind("1.", 0) != 0) {
        throw py::import_error("it was built with a pybind11 that does not know NumPy " + version);
    }
#endif
}

}  // namespace

PYBIND11_MODULE(_native, module) {
    refuse_unknown_numpy();
    module.doc() = "Native part of RealModel. realmodel.core is the interface to use.";
    realmodel::bindings::bind_parts(module);
}
