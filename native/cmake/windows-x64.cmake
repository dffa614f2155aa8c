# SPDX-License-Identifier: GPL-3.0-or-later
# Toolchain file: compiles for Windows x64 on Debian, with mingw-w64. What is not of the compiler lies in
# build/windows/root, where scripts/cross_tools.sh puts it: /usr/include has the headers of Linux.

set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
# The posix kind: std::thread and std::mutex are of the C++ library there.
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix) # GoogleTest asks for one
# Programs, which are tests, contain the compiler's libraries, too.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)

cmake_path(SET windows_root NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../../build/windows/root")
set(CMAKE_FIND_ROOT_PATH "${windows_root}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH) # Eigen's and pybind11's are the same for all systems

# The static OpenMP library, since FindOpenMP takes that of a DLL first, which no user has.
execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libgomp.a
    OUTPUT_VARIABLE static_openmp OUTPUT_STRIP_TRAILING_WHITESPACE)
set(OpenMP_gomp_LIBRARY "${static_openmp}" CACHE FILEPATH "" FORCE)
