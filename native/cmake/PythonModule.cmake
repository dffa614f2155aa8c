# SPDX-License-Identifier: GPL-3.0-or-later
# The Python module realmodel._native, for the interpreter given by -DPython_EXECUTABLE.
# It is written into the add-on's folder with the ABI in its name, beside those for other versions.

set(PYBIND11_FINDPYTHON ON)
find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)

# scripts/build.sh keeps a newer pybind11 in build/tools than Debian 12 has: one that knows NumPy 2.
file(GLOB pybind11_from_tools
    "${PROJECT_SOURCE_DIR}/build/tools/lib/python3*/site-packages/pybind11/share/cmake/pybind11")
find_package(pybind11 2.10 REQUIRED CONFIG HINTS ${pybind11_from_tools})
if(pybind11_VERSION VERSION_LESS 2.12)
    message(STATUS "pybind11 ${pybind11_VERSION} does not know NumPy 2: the module will need NumPy 1. "
        "scripts/build.sh fetches a newer one.")
endif()

# native/bindings/NAME.cpp defines realmodel::bindings::bind_NAME; the list of calls is made from
# the files, in the order of their names, so that a new part needs no edit elsewhere.
file(GLOB bindings_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/native/bindings/*.cpp")
list(SORT bindings_sources)
set(bindings_declarations "")
set(bindings_calls "")
foreach(source IN LISTS bindings_sources)
    cmake_path(GET source STEM part)
    if(NOT part STREQUAL "module")
        string(APPEND bindings_declarations "void bind_${part}(pybind11::module_& module);\n")
        string(APPEND bindings_calls "    bind_${part}(module);\n")
    endif()
endforeach()
configure_file("${CMAKE_CURRENT_LIST_DIR}/bind_parts.hpp.in" "${CMAKE_CURRENT_BINARY_DIR}/bindings/bind_parts.hpp" @ONLY)

pybind11_add_module(_native MODULE NO_EXTRAS ${bindings_sources})
target_include_directories(_native PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/bindings")
target_link_libraries(_native PRIVATE realmodel realmodel_warnings)
# Nothing of the libraries inside may be seen from outside: Blender has copies of its own.
target_link_options(_native PRIVATE -Wl,--exclude-libs,ALL $<$<CONFIG:Release>:-s>)
set_target_properties(_native PROPERTIES
    LIBRARY_OUTPUT_DIRECTORY "${PROJECT_SOURCE_DIR}/addon/realmodel")
