// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module realmodel._native_cuda, which `core` opens where a user chooses the device
// "cuda".
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "opened_device.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_native_cuda, module) {
    using realmodel::cuda::OpenedDevice;
    module.doc() = "Merging of vertices and kriging on a GPU.";
    py::class_<OpenedDevice>(module, "Device", "An open device.")
        .def_property_readonly("name", &OpenedDevice::name)
        .def_property_readonly(
            "functions",
            [](const OpenedDevice& self) {
                return py::capsule(&self.device(), "realmodel.Device");
            },
            "A capsule for Execution, which keeps this object.")
        .def("messages", &OpenedDevice::take_messages,
             "What was left to the CPU or done in tiles since the last call.");
    module.def("open_device", &realmodel::cuda::open_device,
               "Opens the first GPU. Raises RuntimeError: why there is none.");
}
