// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module realmodel._native: thin, NumPy arrays in and out. Every other file NAME.cpp of
// this folder defines realmodel::bindings::bind_NAME(module) and is found by CMake.
#include <pybind11/pybind11.h>

#include "bind_parts.hpp"

PYBIND11_MODULE(_native, module) {
    module.doc() = "Native part of RealModel. realmodel.core is the interface to use.";
    realmodel::bindings::bind_parts(module);
}
