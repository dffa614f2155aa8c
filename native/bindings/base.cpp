// SPDX-License-Identifier: GPL-3.0-or-later
// VERSION, Execution, InputError and Cancelled.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <exception>

#include "execution.hpp"
#include "realmodel/base/device.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/base/memory.hpp"
#include "realmodel/base/version.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

// The types live as long as the interpreter: they are never released, because at its end there may
// be nothing left to release them with.
py::handle input_error_type;
py::handle cancelled_type;

py::handle add_exception(py::module_& module, const char* name, PyObject* base, const char* doc) {
    const std::string full_name = py::cast<std::string>(module.attr("__name__")) + "." + name;
    py::object type = py::reinterpret_steal<py::object>(
        PyErr_NewExceptionWithDoc(full_name.c_str(), doc, base, nullptr));
    if (!type) throw py::error_already_set();
    module.add_object(name, type);
    return type.release();
}

void raise_input_error(const InputError& error) {
    py::object raised = py::reinterpret_borrow<py::object>(input_error_type)(py::str(error.what()));
    raised.attr("kind") = error.kind;
    raised.attr("surface") = error.surface;
    raised.attr("items") = error.items;
    raised.attr("place") =
        error.place
            ? py::object(py::make_tuple((*error.place)[0], (*error.place)[1], (*error.place)[2]))
            : py::object(py::none());
    PyErr_SetObject(input_error_type.ptr(), raised.ptr());
}

void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
        raise_input_error(error);
    } catch (const Cancelled& error) {
        PyErr_SetString(cancelled_type.ptr(), error.what());
    }
}

/// @throws pybind11::value_error  where they are of another version of this library
const Device* functions_of(const py::object& device) {
    if (device.is_none()) return nullptr;
    const py::object capsule = device.attr("functions");
    const auto* const functions =
        static_cast<const Device*>(PyCapsule_GetPointer(capsule.ptr(), "realmodel.Device"));
    if (functions == nullptr) throw py::error_already_set();
    if (functions->layout == Device::kLayout) return functions;
    throw py::value_error("_native_cuda is of another version of RealModel: build it again");
}

}  // namespace

void bind_base(py::module_& module) {
    module.attr("VERSION") = version();
    module.def("keep_waiting_threads_asleep", &keep_waiting_threads_asleep,
               "Has OpenMP's threads sleep while they wait, though its library was loaded before.");
    module.def("available_memory", &available_memory,
               "Bytes that this process may still take: the least of what the machine has free and "
               "what its control groups and its own limit leave.");

    input_error_type = add_exception(
        module, "InputError", PyExc_ValueError,
        "The input cannot be used: kind (str), surface (int, -1: none), items (list of int), "
        "place ((x, y, z) or None).");
    cancelled_type = add_exception(module, "Cancelled", PyExc_Exception,
                                   "The work was stopped by Execution.cancel().");
    py::register_exception_translator(&translate);

    py::class_<WatchedExecution>(module, "Execution",
                                 "How a long call is run, watched from another thread and stopped. "
                                 "threads: 0 for as many as "
                                 "there are; device: a Device of _native_cuda, or None. No "
                                 "result depends on either.")
        .def(py::init([](int threads, const py::object& device) {
                 return new WatchedExecution{threads, device, functions_of(device), {}};
             }),
             py::arg("threads") = 0, py::arg("device") = py::none())
        .def_property_readonly(
            "fraction", [](const WatchedExecution& of) { return of.progress.fraction(); },
            "Share of the work done, 0 to 1.")
        .def_property_readonly(
            "text", [](const WatchedExecution& of) { return of.progress.text(); },
            "What is being done.")
        .def_property_readonly(
            "cancelled", [](const WatchedExecution& of) { return of.progress.cancelled(); },
            "True once cancel() was called.")
        .def(
            "cancel", [](WatchedExecution& of) { of.progress.cancel(); },
            "Makes the call raise Cancelled soon.");
}

}  // namespace realmodel::bindings
