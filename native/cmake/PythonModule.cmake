# SPDX-License-Identifier: GPL-3.0-or-later
# The Python module realmodel._native. Only native/bindings is compiled for one version of Python:
# everything else is the library realmodel, compiled once.
#
#   _native            for the interpreter given by -DPython_EXECUTABLE, written into the add-on's folder
#                      with the ABI in its name, beside those for other versions
#   packaged_modules   for versions of which only the headers are there, for scripts/package.sh:
#                      -DREALMODEL_PACKAGED_PYTHONS=SUFFIX=FOLDER[:FOLDER...][:LIBRARY.a];...
#                      written into packaged_modules/ of the build folder as _native.SUFFIX. LIBRARY.a:
#                      the names of Python, without which Windows links no module

if(CMAKE_CROSSCOMPILING)
    set(PYBIND11_NOPYTHON ON) # no interpreter here could load it: only packaged_modules
else()
    set(PYBIND11_FINDPYTHON ON)
    find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)
endif()

# scripts/build.sh keeps a newer pybind11 in build/tools than Debian 12 has: one that knows NumPy 2. pip brings its own.
if(NOT SKBUILD)
    file(GLOB pybind11_from_tools
        "${PROJECT_SOURCE_DIR}/build/tools/lib/python3*/site-packages/pybind11/share/cmake/pybind11")
endif()
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

if(APPLE AND CMAKE_CROSSCOMPILING)
    set(CMAKE_SHARED_MODULE_CREATE_CXX_FLAGS -shared) # ziglang links no bundles; Python loads both kinds
endif()

# What is the same for all of them.
function(finish_python_module target)
    build_by_folder(${target})
    target_include_directories(${target} PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/bindings")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Os>) # the zip has them three times; they only pass on
    target_link_libraries(${target} PRIVATE realmodel realmodel_settings realmodel_warnings realmodel_gmp)
    set_target_properties(${target} PROPERTIES
        DEFINE_SYMBOL "" # or the same source would be another one for each of them
        REALMODEL_GMP_INSIDE ON)
    if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
        set(exports "${PROJECT_SOURCE_DIR}/native/cmake/module_exports.map")
        target_link_options(${target} PRIVATE "-Wl,--version-script=${exports}" $<$<CONFIG:Release>:-s>)
        set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS "${exports}")
    elseif(MINGW)
        # The compiler's libraries go inside, and only the entry is shown. The same objects give the same bytes.
        target_link_options(${target} PRIVATE
            -static -Wl,--exclude-all-symbols -Wl,--no-insert-timestamp $<$<CONFIG:Release>:-s>)
    elseif(APPLE)
        # Python's names are those of the process that loads it.
        target_link_options(${target} PRIVATE -undefined dynamic_lookup $<$<CONFIG:Release>:-s>)
    endif()
endfunction()

if(NOT CMAKE_CROSSCOMPILING)
    pybind11_add_module(_native MODULE NO_EXTRAS ${bindings_sources})
    finish_python_module(_native)
    if(SKBUILD) # pip: into the wheel, and nothing into the sources
        install(TARGETS _native LIBRARY DESTINATION realmodel COMPONENT wheel)
    else()
        set_target_properties(_native PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${PROJECT_SOURCE_DIR}/addon/realmodel")
    endif()
endif()

set(REALMODEL_PACKAGED_PYTHONS "" CACHE STRING "Ends of module names and the folders of the headers, for packaged_modules")
add_custom_target(packaged_modules)
foreach(entry IN LISTS REALMODEL_PACKAGED_PYTHONS)
    if(NOT entry MATCHES "^([^=]+)=(.+)$")
        message(FATAL_ERROR "REALMODEL_PACKAGED_PYTHONS: '${entry}' is not SUFFIX=FOLDER[:FOLDER...]")
    endif()
    set(suffix "${CMAKE_MATCH_1}")
    string(REPLACE ":" ";" header_folders "${CMAKE_MATCH_2}")
    set(libraries ${header_folders})
    list(FILTER libraries INCLUDE REGEX "\\.a$")
    list(FILTER header_folders EXCLUDE REGEX "\\.a$")
    string(MAKE_C_IDENTIFIER "packaged_${suffix}" target)
    add_library(${target} MODULE EXCLUDE_FROM_ALL ${bindings_sources})
    finish_python_module(${target})
    target_link_libraries(${target} PRIVATE pybind11::headers ${libraries})
    target_include_directories(${target} SYSTEM PRIVATE ${header_folders})
    set_target_properties(${target} PROPERTIES
        PREFIX "" OUTPUT_NAME "_native" SUFFIX ".${suffix}"
        LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/packaged_modules")
    add_dependencies(packaged_modules ${target})
endforeach()
