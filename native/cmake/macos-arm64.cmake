# SPDX-License-Identifier: GPL-3.0-or-later
# Toolchain file: compiles for macOS on Apple's processors, on Debian, with clang from PyPI's ziglang, which brings
# Apple's headers and a C++ library that goes into what is linked. What is not of the compiler lies in
# build/macos/root, where scripts/cross_tools.sh puts it: /usr/include has the headers of Linux.

set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR arm64)
cmake_path(SET tools NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../../build/macos")
set(CMAKE_CXX_COMPILER "${tools}/bin/clang++")
set(CMAKE_CXX_FLAGS_INIT -DBOOST_NO_CXX98_FUNCTION_BASE) # what C++17 removed; Boost 1.74 knows no library without it
set(CMAKE_AR "${tools}/bin/ar" CACHE FILEPATH "")
set(CMAKE_RANLIB "${tools}/bin/ranlib" CACHE FILEPATH "")

set(CMAKE_FIND_ROOT_PATH "${tools}/root")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH) # Eigen's and pybind11's are the same for all systems
