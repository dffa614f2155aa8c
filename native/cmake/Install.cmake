# SPDX-License-Identifier: GPL-3.0-or-later
# cmake --install: the library, its public headers, and a CMake package, for
#   find_package(RealModel)
#   target_link_libraries(PROGRAM PRIVATE RealModel::realmodel)
# native/examples/two_layers is such a program.
include(CMakePackageConfigHelpers)

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/RealModel")
install(TARGETS realmodel EXPORT RealModelTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT realmodel)
install(DIRECTORY include/realmodel DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT realmodel
    FILES_MATCHING PATTERN "*.hpp")
install(EXPORT RealModelTargets NAMESPACE RealModel:: DESTINATION "${package_folder}" COMPONENT realmodel)

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/RealModelConfig.cmake.in"
    "${CMAKE_CURRENT_BINARY_DIR}/RealModelConfig.cmake" INSTALL_DESTINATION "${package_folder}")
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/RealModelConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES
    "${CMAKE_CURRENT_BINARY_DIR}/RealModelConfig.cmake"
    "${CMAKE_CURRENT_BINARY_DIR}/RealModelConfigVersion.cmake"
    DESTINATION "${package_folder}" COMPONENT realmodel)
