# SPDX-License-Identifier: GPL-3.0-or-later
# GMP, as the interface target realmodel_gmp.
#
# A target with the property REALMODEL_GMP_INSIDE gets the static library, so that it needs no GMP on
# the machine where it runs. Debian's static library is compiled for position-independent programs
# (-fPIE), which would do for a shared object too but for two things: what GMP exports could be
# replaced from outside, so nothing of it is exported (--exclude-libs); and it reads stdin, stdout and
# stderr as if they were variables of the program, so it gets variables of ours (--wrap,
# gmp/streams.cpp). -z text has the linker refuse code that would have to be changed when it is loaded.
# It is tried out here; where it does not work the shared library is taken.

find_library(GMP_STATIC_LIBRARY "${CMAKE_STATIC_LIBRARY_PREFIX}gmp${CMAKE_STATIC_LIBRARY_SUFFIX}")

set(gmp_inside_sources "")
set(gmp_inside_options "")
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    set(gmp_inside_sources "${CMAKE_CURRENT_LIST_DIR}/gmp/streams.cpp")
    set(gmp_inside_options -Wl,--exclude-libs,ALL -Wl,-z,text
        -Wl,--wrap=stdin -Wl,--wrap=stdout -Wl,--wrap=stderr)
endif()

if(NOT GMP_STATIC_LIBRARY)
    set(REALMODEL_GMP_INSIDE_WORKS OFF)
elseif(GMP_LIBRARY STREQUAL GMP_STATIC_LIBRARY)
    set(REALMODEL_GMP_INSIDE_WORKS ON) # there is no other
elseif(NOT DEFINED REALMODEL_GMP_INSIDE_WORKS)
    try_compile(REALMODEL_GMP_INSIDE_WORKS "${CMAKE_CURRENT_BINARY_DIR}/gmp_trial"
        SOURCES "${CMAKE_CURRENT_LIST_DIR}/gmp/trial.cpp" ${gmp_inside_sources}
        CMAKE_FLAGS "-DINCLUDE_DIRECTORIES=${GMP_INCLUDE_DIR}"
        COMPILE_DEFINITIONS ${CMAKE_SHARED_LIBRARY_CXX_FLAGS}
        LINK_OPTIONS ${CMAKE_SHARED_LIBRARY_CREATE_CXX_FLAGS} ${gmp_inside_options}
        LINK_LIBRARIES "${GMP_STATIC_LIBRARY}")
endif()
if(NOT REALMODEL_GMP_INSIDE_WORKS)
    message(STATUS "The module will need ${GMP_LIBRARY} where it runs: there is no static one that can be linked into it")
endif()

set(wants_inside "$<AND:$<BOOL:${REALMODEL_GMP_INSIDE_WORKS}>,$<BOOL:$<TARGET_PROPERTY:REALMODEL_GMP_INSIDE>>>")
add_library(realmodel_gmp INTERFACE)
target_include_directories(realmodel_gmp SYSTEM INTERFACE ${GMP_INCLUDE_DIR})
target_sources(realmodel_gmp INTERFACE "$<${wants_inside}:${gmp_inside_sources}>")
target_link_options(realmodel_gmp INTERFACE "$<${wants_inside}:${gmp_inside_options}>")
target_link_libraries(realmodel_gmp INTERFACE
    "$<IF:${wants_inside},${GMP_STATIC_LIBRARY},${GMPXX_LIBRARY};${GMP_LIBRARY}>")
