# SPDX-License-Identifier: GPL-3.0-or-later
# Libraries the native part stands on (docs/dev/dependencies.md gives the reason of each).
# What they bring is collected in the interface target realmodel_dependencies. No public header
# includes any of them: who uses the library needs them only to link (RealModelConfig.cmake.in).

# CGAL is used as headers only, without its CMake package, which would link GMP and MPFR into
# everything. Its exact predicates need GMP; MPFR only comes in with its exact constructions
# (kernel EPECK), which we do not use.
find_package(Eigen3 NO_MODULE QUIET) # 3.4 or 5: asked for 3.4, Eigen says no to 5
find_path(CGAL_INCLUDE_DIR CGAL/version.h)
find_path(BOOST_INCLUDE_DIR boost/version.hpp)
find_path(NANOFLANN_INCLUDE_DIR nanoflann.hpp)
find_path(GMP_INCLUDE_DIR gmpxx.h)
find_library(GMP_LIBRARY gmp)
find_library(GMPXX_LIBRARY gmpxx)
set(missing "")
foreach(found IN ITEMS
        "Eigen=Eigen3_DIR" "CGAL=CGAL_INCLUDE_DIR" "Boost=BOOST_INCLUDE_DIR" "nanoflann=NANOFLANN_INCLUDE_DIR"
        "GMP=GMP_INCLUDE_DIR" "GMP's library=GMP_LIBRARY" "GMP's C++ library=GMPXX_LIBRARY")
    string(REPLACE "=" ";" found "${found}")
    list(GET found 0 name)
    list(GET found 1 variable)
    if(NOT ${variable})
        list(APPEND missing "${name}")
    endif()
endforeach()
if(missing)
    list(JOIN missing ", " missing)
    message(FATAL_ERROR "RealModel cannot be compiled: this machine lacks ${missing}. "
        "On Debian and Ubuntu run scripts/install_dependencies.sh build; elsewhere see docs/dev/dependencies.md.")
endif()
if(Eigen3_VERSION VERSION_LESS 3.4)
    message(FATAL_ERROR "RealModel needs Eigen 3.4 or newer; ${Eigen3_DIR} is ${Eigen3_VERSION}")
endif()
if(REALMODEL_OPENMP)
    find_package(OpenMP REQUIRED COMPONENTS CXX)
    set(realmodel_threads OpenMP::OpenMP_CXX)
else()
    find_package(Threads REQUIRED)
    set(realmodel_threads Threads::Threads)
endif()
include(Gmp)

add_library(realmodel_dependencies INTERFACE)
target_include_directories(realmodel_dependencies SYSTEM INTERFACE
    ${NANOFLANN_INCLUDE_DIR} ${CGAL_INCLUDE_DIR})
target_compile_definitions(realmodel_dependencies INTERFACE
    CGAL_USE_GMP=1 CGAL_USE_GMPXX=1 EIGEN_MPL2_ONLY)
target_link_libraries(realmodel_dependencies INTERFACE
    Eigen3::Eigen ${realmodel_threads} realmodel_gmp)
if(NOT REALMODEL_OPENMP)
    target_compile_options(realmodel_dependencies INTERFACE -fopenmp-simd) # takes no library
endif()
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_link_options(realmodel_dependencies INTERFACE -Wl,--as-needed)
endif()
