# SPDX-License-Identifier: GPL-3.0-or-later
# Flags of our own targets, kept in interface targets that nobody else gets:
#   realmodel_settings   floating point, sanitizers: for all our code
#   realmodel_warnings   warnings as errors

if(NOT CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    message(FATAL_ERROR "RealModel builds with g++ or clang++, which have whole numbers of 128 bits; this is "
        "${CMAKE_CXX_COMPILER_ID}. Pass -DCMAKE_CXX_COMPILER=g++ (on Windows that of MinGW, or LLVM's clang++).")
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_SKIP_RPATH ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1") # for the sanitizers: assertions stay, lines are named

find_program(REALMODEL_CCACHE ccache)
if(REALMODEL_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # Without these it keeps nothing that includes a precompiled header, as the tests do.
    set(CMAKE_CXX_COMPILER_LAUNCHER
        "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros "${REALMODEL_CCACHE}")
endif()

add_library(realmodel_settings INTERFACE)
# No fused multiply-add: the same bytes on every machine. Rounding may change at run time, because
# CGAL's interval arithmetic changes it: the compiler must not fold or move such operations.
target_compile_options(realmodel_settings INTERFACE -ffp-contract=off -frounding-math)
if(REALMODEL_PLAIN_DOUBLE)
    target_compile_definitions(realmodel_settings INTERFACE REALMODEL_PLAIN_DOUBLE)
endif()
if(REALMODEL_SANITIZE)
    target_compile_options(realmodel_settings INTERFACE
        -fsanitize=${REALMODEL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    # AddressSanitizer finds what is used beyond an object or through null, too, and no processor that we build for
    # minds how data lie: these checks take a quarter of clang++'s time.
    if(REALMODEL_SANITIZE MATCHES "address" AND REALMODEL_SANITIZE MATCHES "undefined")
        target_compile_options(realmodel_settings INTERFACE -fno-sanitize=object-size,null,alignment,vptr)
    endif()
    # What is inlined with its checks takes most of clang++'s time: two thirds of it this way.
    target_compile_options(realmodel_settings INTERFACE
        $<$<CXX_COMPILER_ID:Clang>:SHELL:-mllvm -inline-threshold=30>)
    target_link_options(realmodel_settings INTERFACE -fsanitize=${REALMODEL_SANITIZE})
    if(REALMODEL_SANITIZE MATCHES "address")
        target_sources(realmodel_settings INTERFACE "${CMAKE_CURRENT_LIST_DIR}/leak_suppressions.cpp")
    endif()
endif()

# What goes into a module that is loaded into a running process: its own thread-local variables (a few bytes;
# the C library keeps room for that) are addressed directly. Not so in the bindings: there the C++ library's
# variables are meant too, for which there is no room where that library was itself loaded late (module bpy).
add_library(realmodel_loaded_late INTERFACE)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_compile_options(realmodel_loaded_late INTERFACE -ftls-model=initial-exec)
endif()

# The sources of each folder are one unit: half of the processor time, because most of a file's is for headers.
# In `dev` there is a unit for each file: a change of one compiles one, and it is seen that each includes what it
# needs. Sources with options of their own stay alone.
function(build_by_folder target)
    if(CMAKE_BUILD_TYPE STREQUAL "Debug")
        return()
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP
        UNITY_BUILD_RELOCATABLE ON) # where CMake knows it: the same text, and so found by ccache, in each clone
    get_target_property(sources ${target} SOURCES)
    foreach(source IN LISTS sources)
        cmake_path(GET source PARENT_PATH folder)
        cmake_path(RELATIVE_PATH folder BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}")
        string(MAKE_C_IDENTIFIER "${folder}" group)
        set_source_files_properties("${source}" PROPERTIES UNITY_GROUP ${group})
    endforeach()
    # g++ takes what an included source keeps to itself for what a header does. And it lets a large unit grow by 40 %
    # only, so that small functions that are called most are not inlined.
    target_compile_options(${target} PRIVATE
        "$<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage;--param=inline-unit-growth=60>")
endfunction()

add_library(realmodel_warnings INTERFACE)
target_compile_options(realmodel_warnings INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Werror)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # A loop that clang does not vectorise (it is stricter about changing rounding) is no error.
    target_compile_options(realmodel_warnings INTERFACE -Wno-pass-failed)
endif()
